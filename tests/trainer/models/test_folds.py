"""Folds of cross-validation: repeats apart, each depth and each speed held out whole."""

import dataclasses
from collections import Counter

import numpy as np
from support.small import DEPTH_M, press, recording, training

from springpot.trainer.models.folds import fold_families, held_out_whole, pieces, repeats_apart
from springpot.trainer.models.training_set import TrainingSet, training_set

SHARES = (0.3, 0.7, 1.0)
SPEEDS_HZ = (0.5, 1.0, 3.0, 5.0)


def with_repeats() -> TrainingSet:
    """Every press twice: the repeat a little slower and shallower, as by a hand or a valve."""
    return training_set(
        [
            recording(f"{share}-{hz}-{slower}", press(hz * slower, share * DEPTH_M * deeper))
            for share in SHARES
            for hz in SPEEDS_HZ
            for slower, deeper in ((1.0, 1.0), (0.97, 0.99))
        ],
        smooth_s=0.0,
    )


def test_repeats_of_one_press_go_to_different_folds() -> None:
    data = with_repeats()
    for seed in range(20):
        number = repeats_apart(data.depths_m, data.dt_s, 5, seed).number
        assert np.all(number[::2] != number[1::2])
        assert max(Counter(number.tolist()).values()) == 5  # 24 recordings in 5 folds


def test_each_depth_and_each_speed_is_held_out_whole() -> None:
    data = with_repeats()
    rows = data.bounds[:-1] + 1
    depth, speed = held_out_whole(data, rows)
    assert depth.number.tolist() == [group for group in (0, 1, 2) for _ in range(8)]
    assert np.all(speed.number[::2] == speed.number[1::2])
    assert speed.tested == (0, 1, 2, 3, 4)


def test_what_is_as_deep_as_nothing_else_is_not_held_out() -> None:
    data = with_repeats()
    _, depth, speed = fold_families(data, np.arange(data.rows_total), seed=0)
    assert depth.tested == (0, 1)  # without the deepest, only extrapolation is measured
    assert speed.tested == (0, 1, 2, 3, 4)


def test_noise_on_repeats_makes_no_further_conditions() -> None:
    noise, item = np.random.default_rng(1), training()[5]
    noisy_m = [item.position_m + noise.normal(0.0, 2e-6, 1000) for _ in range(6)]
    same = [dataclasses.replace(item, position_m=position_m) for position_m in noisy_m]
    data = training_set(same, smooth_s=0.0)
    assert held_out_whole(data, np.arange(data.rows_total)) == []


def test_a_piece_is_in_one_fold_of_each_family() -> None:
    data = training_set(training(), smooth_s=0.0)
    families = fold_families(data, np.arange(data.rows_total), seed=3)
    assert len(families) == 3
    piece = pieces(families)
    for folds in families:
        pairs = set(zip(piece.tolist(), folds.number.tolist(), strict=True))
        assert len(pairs) == piece.max() + 1
