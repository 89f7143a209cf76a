"""The passive model where recordings leave something open: a depth not reached, a gap between."""

from dataclasses import replace
from itertools import product
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from support.small import DT_S, damage, flow, passive_force_n, passive_model, press

from springpot import Recording, predict
from springpot.codegen.arrays import Samples, rms
from springpot.codegen.model.passive import Hammerstein, Memory
from springpot.host.metrics import accuracy
from springpot.host.recording.protocols import load_protocol
from springpot.host.recording.session import open_press_device, record_session
from springpot.trainer.features import highpass
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.depths import DepthMotion
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.passive import passive_fit
from springpot.trainer.models.passive.nonnegative import normal_equations, sparse_solve
from springpot.trainer.models.passive.passive_force import simulate_passive, store_memory
from springpot.trainer.models.passive.passive_terms import Terms, build_model, plain_terms
from springpot.trainer.models.passive.start import select_start
from springpot.trainer.models.passive.term_values import build_design_matrix, simulate_flow
from springpot.trainer.models.predict import predict_n
from springpot.trainer.models.training_set import build_training_set
from springpot.trainer.recordings.recording_file import read_recordings
from springpot.trainer.recordings.signals import estimate_history_m

DEPTH_M = 0.01
MODES = ((0.02, 2.0), (0.2, 1.5), (2.0, 1.5))  # s, N
SPRING_N = 6.0
# Relaxes by four fifths within 0.3 s: the tool leaves it on each way back.
LETS_GO = Hammerstein(
    origin_m=0.0, span_m=DEPTH_M, elastic_n=np.full(9, 1.0), tau_s=np.array([0.1, 0.3]),
    branch_n=np.full((2, 9), 3.0), radius_m=np.zeros(0), stop_n=np.zeros((0, 9)), bias_n=0.0,
    recovers=True)  # fmt: skip


def tissue(name: str, position_m: np.ndarray, stiffening: float) -> Recording:
    """An object whose spring and three relaxations follow one exponential curve of depth."""
    curve = np.expm1(stiffening * position_m / DEPTH_M) / np.expm1(stiffening)
    force_n = SPRING_N * curve
    for tau_s, weight_n in MODES:
        force_n = force_n + weight_n * highpass(curve, tau_s, DT_S)
    return Recording(name, position_m, force_n, DT_S, zero="min")


def about(share: float, stiffening: float) -> list[Recording]:
    """Cycles of a tenth of the depth about one share of it, at three speeds."""
    return [
        tissue(f"{share}-{hz}", DEPTH_M * (share - 0.1) + press(hz, 0.2 * DEPTH_M, 2), stiffening)
        for hz in (0.5, 2.0, 8.0)
    ]


@pytest.mark.slow
def test_a_fold_without_the_deepest_recording_has_ordinary_weights_and_errors() -> None:
    # Without a penalty on bends: weights of 1e25 on the curves that the fold never reached.
    motions_m = press(0.5, 0.005), press(2.0, 0.005), press(1.0, DEPTH_M)
    data = build_training_set([tissue(f"{k}", each, 4.0) for k, each in enumerate(motions_m)], 0.0)
    peak_n, rows = data.trained.max_n, np.arange(0, data.rows_total, 5)
    for nodes in passive_fit.NODES:
        terms = plain_terms(data, nodes)
        values, force_n = build_design_matrix(terms, data, rows), data.force_n(rows)
        for penalty in passive_fit.PENALTIES:
            for held in range(3):
                out = data.recording_index(rows) == held
                kept = normal_equations(values[~out], force_n[~out]).penalised(
                    penalty * terms.roughness()
                )
                weights = kept.solve()
                assert weights.max() < 10.0 * peak_n
                assert normal_equations(values[out], force_n[out]).rmse(weights) < peak_n


@pytest.mark.slow
@pytest.mark.parametrize(("stiffening", "percent"), [(4.0, 1.0), (12.0, 4.0)])
def test_a_rise_between_two_trained_depths_goes_on_smoothly(
    stiffening: float, percent: float
) -> None:
    training = [item for share in (0.2, 0.55, 0.85) for item in about(share, stiffening)]
    model = fit_model("hammerstein", "x", training, FitOptions(smooth_s=0.0)).model
    tests = about(0.4, stiffening)
    found = accuracy([item.force_n for item in tests], [predict_n(model, item) for item in tests])
    assert found.rmse_percent_of_peak < percent  # ramps, where bends cost nothing: 3.7


def test_slopes_that_no_row_saw_go_on_as_the_last_ones_seen() -> None:
    data = build_training_set([tissue("half", press(1.0, 0.5 * DEPTH_M), 2.0)], smooth_s=0.0)
    whole = build_training_set([tissue("whole", press(1.0, DEPTH_M), 2.0)], smooth_s=0.0)
    terms, rows = plain_terms(whole, 9), np.arange(data.rows_total)
    normal = normal_equations(build_design_matrix(terms, data, rows), data.force_n(rows))
    weights = sparse_solve(normal.penalised(1e-4 * terms.roughness()), terms.blocks, 0.005)
    spring_n = build_model(terms, weights).elastic_n
    true_n = SPRING_N * 2.0 * np.exp(2.0 * np.linspace(0.0, 1.0, 9)) / np.expm1(2.0)
    assert np.all(spring_n < 2.5 * true_n)
    assert spring_n[-1] > 0.7 * true_n[4]  # where rows end


@pytest.mark.slow
@pytest.mark.parametrize(("stiffening", "deeper"), [(4.0, 1.1), (2.0, 1.2), (-1.0, 1.2)])
def test_an_object_is_pressed_deeper_than_it_was_trained(stiffening: float, deeper: float) -> None:
    """Slopes of what stiffens grow; a constant one errs by more than ten times as much."""
    presses = [(share, hz) for share in (0.4, 0.7, 1.0) for hz in (0.5, 2.0)]
    training = [tissue(f"{k}", press(hz, share * DEPTH_M), stiffening)
                for k, (share, hz) in enumerate(presses)]  # fmt: skip
    model = fit_model("hammerstein", "x", training, FitOptions()).model
    data = build_training_set(training, None)
    level = passive_fit.select_passive(data, FitOptions())[0].fit_recovery(data)
    assert model.hammerstein is not None
    assert model.hammerstein.nodes > level.nodes or stiffening < 0.0
    constant = replace(model, hammerstein=level)
    deep = tissue("deep", press(1.0, deeper * DEPTH_M), stiffening)
    error_n, its_n = (
        np.abs(predict_n(each, deep) - deep.force_n).max() for each in (model, constant)
    )
    assert error_n < 0.03 * deep.force_n.max()
    assert stiffening < 0.0 or error_n < its_n / 10.0


@pytest.mark.slow
def test_an_object_that_flows_is_fitted_by_flow() -> None:
    recordings = []
    for hz, share in product((0.5, 3.0), (0.3, 0.6, 1.0)):
        depth_m = press(hz, share * DEPTH_M)
        h, before, held = 0.0, 0.0, []
        for u in (depth_m / DEPTH_M).tolist():  # h' = u' - 40 |h|^3 h, half a step before and after
            half, before = 0.5 * (u - before), u
            h += half
            h = h / (1.0 + 3.0 * 40.0 * DT_S * abs(h) ** 3) ** (1.0 / 3.0) + half
            held.append(h)
        force_n = np.maximum(4.0 * depth_m / DEPTH_M + 3.0 * np.array(held), 0.0)
        recordings.append(Recording(f"{hz}-{share}", depth_m, force_n, DT_S))
    fit = fit_model("hammerstein", "x", recordings, FitOptions(smooth_s=0.0))
    assert "flow" in fit.metadata["law"]
    error_n = [predict_n(fit.model, each) - each.force_n for each in recordings]
    assert np.sqrt(np.mean(np.concatenate(error_n) ** 2)) < 0.01 * 7.0


@pytest.mark.slow
def test_an_object_that_is_damaged_is_fitted_by_damage_and_one_session() -> None:
    """Softer below the deepest press of the session: alone, no press would show it."""
    recordings, deepest_m, start_s = [], 0.0, 0.0
    for share in (0.4, 0.7, 0.5, 1.0, 0.6, 0.3, 0.9):
        depth_m = press(1.0, share * DEPTH_M, 2)
        most = np.maximum(np.maximum.accumulate(depth_m), deepest_m)
        worn = np.divide(depth_m, most, out=np.ones_like(depth_m), where=most > 0)
        force_n = 3.0 * depth_m / DEPTH_M + 5.0 * (depth_m / DEPTH_M) ** 2 * worn
        recordings.append(Recording(
            f"{share}", depth_m, force_n, DT_S, session="one", start_s=start_s
        ))  # fmt: skip
        deepest_m, start_s = max(deepest_m, float(depth_m.max())), start_s + 3.0
    fit = fit_model("hammerstein", "x", recordings, FitOptions(smooth_s=0.0))
    assert fit.metadata["law"] == "damage"
    apart = [replace(each, session="") for each in recordings]
    other = fit_model("hammerstein", "x", apart, FitOptions(smooth_s=0.0))
    assert other.model.hammerstein.continues  # found without the times
    assert other.metadata["cv_rmse_n"] < 1.1 * fit.metadata["cv_rmse_n"]
    at_rest = passive_fit.select_passive(build_training_set(apart, 0.0), FitOptions(smooth_s=0.0))[
        0
    ]
    assert fit.metadata["cv_rmse_n"] < 0.25 * at_rest.error_n


def test_an_object_that_lets_go_has_a_surface_that_recovers() -> None:
    recordings = []
    for hz, share in product((1.0, 4.0), (0.6, 1.0)):
        depth_m = press(hz, share * DEPTH_M, 3)
        made = passive_force_n(LETS_GO, depth_m, DT_S, surface=True)
        recordings.append(Recording(f"{hz}-{share}", depth_m, made, DT_S))
    model = fit_model("hammerstein", "x", recordings, FitOptions(smooth_s=0.0)).model
    assert model.hammerstein is not None and model.hammerstein.recovers
    clamped = replace(model, hammerstein=replace(model.hammerstein, recovers=False))
    errors_n = [
        np.sqrt(np.mean([np.mean((predict_n(each, r) - r.force_n) ** 2) for r in recordings]))
        for each in (model, clamped)
    ]
    assert errors_n[0] < 0.5 * errors_n[1]


def choice(law: str, *errors_n: float) -> passive_fit.PassiveChoice:
    rows: Any = SimpleNamespace(peak_n=10.0)
    terms: Any = None
    return passive_fit.PassiveChoice((law,), terms, 1e-3, errors_n, [], rows)


@pytest.mark.parametrize(
    ("plain_n", "richer_n", "law"),
    [
        ((0.20, 0.20), (0.17, 0.17), "flow"),
        ((0.20, 0.20), (0.19, 0.19), "plain"),  # less than a tenth
        ((0.20, 0.20), (0.10, 0.21), "plain"),  # worse in a family of folds
        ((0.010, 0.011), (0.007, 0.008), "plain"),  # a quarter of next to nothing
        ((0.040, 0.040), (0.020, 0.020), "flow"),
        ((0.0, 0.0), (0.0, 0.0), "plain"),
    ],
)
def test_a_richer_law_has_to_gain_what_counts(
    plain_n: tuple[float, ...], richer_n: tuple[float, ...], law: str
) -> None:
    assert passive_fit.select_richer(choice("plain", *plain_n), choice("flow", *richer_n)).law == (
        law,
    )


@pytest.mark.parametrize(("covered", "nodes"), [(True, 25), (False, 13)])
def test_the_finest_curves_alone_need_a_row_between_all_nodes(covered: bool, nodes: int) -> None:
    def laws(count: int) -> Any:
        its = replace(choice("plain", count**-4.0), terms=SimpleNamespace(nodes=count))
        return SimpleNamespace(covers_every_interval=covered, fit_law=lambda _: [its])

    assert passive_fit._select_curves(laws, ())[1].terms.nodes == nodes


@pytest.mark.parametrize("gap", [(0.0, 0.0), (0.0, 0.26), (0.24, 0.51), (0.74, 1.01)])
def test_an_interval_of_a_curve_without_a_row_is_seen(gap: tuple[float, float]) -> None:
    depth = np.linspace(0.0, 1.0, 101)
    depth = depth[(depth < gap[0]) | (depth >= gap[1])]
    laws = SimpleNamespace(
        _data=SimpleNamespace(depths_m=[depth]),
        _rows=SimpleNamespace(rows=np.arange(len(depth))),
        _plain=SimpleNamespace(nodes=5, normalised_depth=lambda depth_m: depth_m),
    )
    assert passive_fit.Laws.covers_every_interval.func(laws) == (gap == (0.0, 0.0))


def test_a_dashpot_that_flows_relaxes_through_a_pause() -> None:
    """Held for 100 s between two recordings, as long as for 100 000 ticks."""
    terms = Terms(0.0, 5e-3, 5, (0.1,), (), (), flow=((0.1, 3, 1),))
    pressed_m = np.concatenate([np.linspace(0.0, 4e-3, 50), np.full(10, 4e-3)])
    at = np.array([50, 51, 59])
    states = [
        simulate_flow(terms, 1e-3, DepthMotion(pressed_m, (0,), (0,), pauses), at)[:, 0]
        for pauses in ((), ((51, 100.0),))
    ]
    held_m = np.concatenate([pressed_m[:51], np.full(100_000, 4e-3)])
    ticked = simulate_flow(
        terms, 1e-3, DepthMotion(held_m, (0,), (0,)), np.array([len(held_m) - 1])
    )
    assert states[0][0] == states[1][0] and states[1][1] < 0.1 * states[0][1]
    assert states[1][1] == pytest.approx(ticked[0, 0], rel=0.01)


def test_a_choice_is_remembered_for_the_options_that_decide_it() -> None:
    data = build_training_set([Recording("a", press(1.0), 300.0 * press(1.0), DT_S)], 0.0)
    few, many = (passive_fit.select_passive(data, FitOptions(poles=p))[0] for p in (2, 9))
    assert few is passive_fit.select_passive(data, FitOptions(poles=2))[0]
    assert len(few.terms.tau_s) < len(many.terms.tau_s)


def test_the_error_on_what_is_held_out_is_that_of_a_fit_without_it() -> None:
    """One of three is ten times as stiff: what the two others say misses nine tenths of it."""
    depth_m = press(1.0)
    springs = [Recording(f"{k}", depth_m, k * depth_m, DT_S) for k in (100.0, 100.0, 1000.0)]
    data = build_training_set(springs, 0.0)
    assert select_start(data, FitOptions()) is data  # nothing tells that one goes on
    choice = passive_fit.select_passive(data, FitOptions())[0]
    missed_n = np.sqrt(np.mean((900.0 * depth_m) ** 2))
    assert choice.folds_n.max() == pytest.approx(missed_n, rel=0.02)


@pytest.mark.slow
def test_short_presses_of_a_silicone_tell_of_long_ones(tmp_path: Path) -> None:
    """With rates by depth the presses are met better, 15 s of sums twice as badly: 0.5 %."""
    url, sets = "sim://ecoflex-00-30", []
    for protocol, seed in (("paper", 1), ("validation", 2)):
        device, folder = open_press_device(url, seed), tmp_path / protocol
        record_session(device, url, protocol, load_protocol(protocol, seed), folder, lambda _: None)
        sets.append(read_recordings([folder]))
    training, longer = sets
    model = fit_model("hammerstein", "pad", training, FitOptions()).model
    forces_n = [predict_n(model, each) for each in longer[:4]]
    found = accuracy([each.force_n for each in longer[:4]], forces_n, [0] * 4)
    assert found.rmse_percent_of_peak < 0.3


def test_a_pad_that_sticks_pushes_no_hand_where_it_was_felt_to_pull() -> None:
    """Pressed for a second and a half, then cycles to the surface: at rest it gives 0 N there."""
    whole_m = np.concatenate([
        np.zeros(100), np.full(1500, 0.8 * DEPTH_M), np.linspace(0.8 * DEPTH_M, 0.0, 300),
        press(1.0, DEPTH_M, 3), press(0.4, 0.6 * DEPTH_M, 2), press(2.0, 0.8 * DEPTH_M, 4),
    ])  # fmt: skip
    u = whole_m / DEPTH_M
    force_n = u + 3.0 * sum(highpass(u, tau_s, DT_S) for tau_s in (0.02, 0.2, 2.0, 20.0))
    felt = Recording("pad", whole_m[1100:], force_n[1100:], DT_S)  # of the hold, its last 0.5 s
    assert felt.force_n[felt.position_m < 0.02 * DEPTH_M].max() < -1.0
    model = fit_model("hammerstein", "x", [felt], FitOptions(smooth_s=0.0)).model
    still_m = np.zeros(100)
    rested_n = predict_n(model.with_start("rested"), Recording("hand", still_m, still_m, DT_S))
    assert model.contact == "always" and rested_n.max() <= 0.0  # 0.17 N, where a bias may push


@pytest.mark.parametrize("goes_on", [False, True])
def test_how_recordings_begin_is_learnt_from_them(goes_on: bool) -> None:
    """An object that relaxes for minutes: pressed five times in a row, or a fresh one each time."""
    recordings, before = [], np.zeros(0)
    for hz, share in ((0.5, 1.0), (0.5, 0.8), (1.0, 1.0), (1.0, 0.8)):
        depth_m = press(hz, share * DEPTH_M, 1)
        curve = np.concatenate([before, np.expm1(2.0 * depth_m / DEPTH_M) / np.expm1(2.0)])
        force_n = SPRING_N * curve + 2.0 * (
            highpass(curve, 1.0, DT_S) + highpass(curve, 100.0, DT_S)
        )
        force_n = np.maximum(force_n[len(before) :], 0.0)
        recordings.append(Recording(f"{hz}-{share}", depth_m, force_n, DT_S, zero="none"))
        before = curve if goes_on else before
    model = fit_model("hammerstein", "x", recordings[:3], FitOptions(smooth_s=0.0)).model
    assert model.hammerstein.continues is goes_on
    other = replace(model, hammerstein=replace(model.hammerstein, continues=not goes_on))
    new = recordings[3]
    its_n, other_n = (np.abs(predict_n(each, new) - new.force_n).max() for each in (model, other))
    assert its_n < 0.5 * other_n


@pytest.mark.parametrize("end_m", [0.0, DEPTH_M])
@pytest.mark.parametrize("surface", [True, False])
def test_a_motion_that_continues_is_the_second_part_of_one(end_m: float, surface: bool) -> None:
    """With branches, a stop, flow and damage, ended at the surface or pressed; and on no hand."""
    stops = {"radius_m": np.array([0.2 * DEPTH_M]), "stop_n": np.full((1, 9), 2.0)}
    law = replace(LETS_GO, **stops, recovers=surface, flow=flow(4.0), damage=damage(np.ones(9)))
    before_m = np.concatenate([press(2.0), np.linspace(0.0, end_m, 300), np.full(2000, end_m)])
    after_m = np.concatenate([np.linspace(end_m, 0.0, 300), press(2.0, 0.8 * DEPTH_M)])

    def along(model: Hammerstein, depth_m: Samples) -> tuple[Samples, Memory]:
        motion = DepthMotion(depth_m, (0,), (0,))
        force_n, _, memory = simulate_passive(model, motion, DT_S, surface)
        return force_n, memory

    whole_n, _ = along(law, np.append(before_m, after_m))
    _, memory = along(law, before_m)
    going_on = replace(law, end_memory=memory, continues=True)
    assert np.array_equal(along(going_on, after_m)[0], whole_n[len(before_m) :])
    for cut in (100, 230, 400):  # on the way in, out, and after it
        going_on = replace(law, end_memory=along(law, before_m[:cut])[1], continues=True)
        assert np.array_equal(along(going_on, before_m[cut:])[0], along(law, before_m)[0][cut:])
    if surface:
        assert not along(going_on, np.zeros(2000))[0].any()


@pytest.mark.parametrize(("from_m", "goes_on"), [(0.3 * DEPTH_M, True), (0.0, False)])
def test_a_recording_that_begins_where_the_only_one_ended_goes_on(
    from_m: float, goes_on: bool
) -> None:
    """Inside the object: above it, where all presses begin and end, that tells nothing."""
    one_m = np.concatenate([press(1.0), np.linspace(0.0, from_m, 100)])
    two_m = np.concatenate([np.full(50, from_m), np.linspace(from_m, 0.0, 100), press(1.0)])
    slow = replace(LETS_GO, tau_s=np.array([0.3, 30.0]), recovers=False)
    whole_m = np.append(one_m, two_m)
    whole_n = simulate_passive(slow, DepthMotion(whole_m, (0,), (0,)), DT_S, surface=True)[0]
    first = Recording("first", one_m, whole_n[: len(one_m)], DT_S, zero="none")
    second = Recording("second", two_m, whole_n[len(one_m) :], DT_S, zero="none")
    model = fit_model("hammerstein", "x", [first], FitOptions(smooth_s=0.0)).model
    assert model.continues_training(two_m) is goes_on
    assert not model.with_start("rested").continues_training(two_m)
    errors_n = [
        rms(predict_n(model.with_start(start), second) - second.force_n)
        for start in ("auto", "rested", "continues")
    ]
    assert errors_n[0] == errors_n[2 if goes_on else 1]
    assert errors_n[2] < 0.5 * errors_n[1] or not goes_on


@pytest.mark.parametrize("cut", [8310, 8500, 8770])
def test_a_recording_cut_out_of_a_longer_one_goes_on(cut: int) -> None:
    """Cycles of an object that relaxes for seconds: rest at the cut errs by 0.09 to 0.4 N."""
    whole_m, slow_s = press(1.0, DEPTH_M, 12), np.array([0.1, 3.0])
    model = replace(passive_model(), hammerstein=replace(LETS_GO, tau_s=slow_s, recovers=False))
    wanted_n = predict_n(model, Recording("whole", whole_m, whole_m, DT_S))[cut:]
    with pytest.warns(UserWarning, match="later: begins in motion inside .*: its own later motion"):
        found_n = predict(model, Recording("later", whole_m[cut:], wanted_n, DT_S))
    assert rms(found_n - wanted_n) < 0.08


def test_without_such_a_sign_a_recording_begins_at_rest() -> None:
    """At its lowest, after a hold, where motion swells or never comes back the same way."""
    cycles_m, held_m = press(1.0, DEPTH_M, 3), np.full(400, 0.3 * DEPTH_M)
    cut_m = cycles_m[int(np.argmax(cycles_m > held_m[0])) :]
    steps_m = np.convolve(np.repeat([3.0, 5.0, 3.0, 1.0] * 3, 400), np.full(50, 0.02), "valid")
    swelling_m = np.sin(np.linspace(0.0, 30.0, 5000)) * np.linspace(0.0, 1.0, 5000)
    for depth_m in (cycles_m, np.append(held_m, cut_m), cut_m[:700], held_m, steps_m, swelling_m):
        assert not len(estimate_history_m(depth_m))
    noisy_m = cut_m + np.random.default_rng(0).normal(0.0, 1e-5, len(cut_m))
    assert (
        min(len(estimate_history_m(noisy_m[k:])) for k in range(0, 700, 100)) > 900
    )  # about a period


@pytest.mark.parametrize(("rest_s", "starts"), [(0.05, True), (300.0, False)])
def test_a_session_is_begun_as_its_later_presses_began(rest_s: float, starts: bool) -> None:
    """Two presses of an object that forgets within minutes; the first is always a fresh one's."""
    slow, depth_m = replace(LETS_GO, tau_s=np.array([1.0, 20.0]), recovers=False), press(2.0)
    timed = [Recording(f"{k}", depth_m, depth_m, DT_S, session="one",
                       start_s=k * (0.5 + rest_s)) for k in range(2)]  # fmt: skip
    (motion,) = build_training_set(timed, 0.0).motions
    forces_n = simulate_passive(slow, motion, DT_S, surface=True)[0]
    forces_n += np.random.default_rng(1).normal(0.0, 0.01, len(forces_n))
    felt = [replace(each, force_n=forces_n[begin : begin + len(depth_m)])
            for each, begin in zip(timed, motion.starts, strict=True)]  # fmt: skip
    found = store_memory(slow, build_training_set(felt, 0.0))
    assert found.continues is starts
    # What is left as the last press begins: minutes later, nothing.
    assert bool(np.abs(found.end_memory.branch_n).max() > 1e-4) is starts


def test_the_residual_of_a_session_is_that_from_rest() -> None:
    """A new press begins as the later ones did, the first one began at rest: else 0.2 N rms."""
    slow, depth_m = replace(LETS_GO, tau_s=np.array([0.3, 40.0]), recovers=False), press(1.0)
    timed = [Recording(f"{k}", depth_m, depth_m, DT_S, session="one", start_s=1.05 * k)
             for k in range(6)]  # fmt: skip
    (motion,) = build_training_set(timed, 0.0).motions
    forces_n = simulate_passive(slow, motion, DT_S, surface=True)[0]
    felt = [replace(each, force_n=forces_n[begin : begin + len(depth_m)])
            for each, begin in zip(timed, motion.starts, strict=True)]  # fmt: skip
    fit = fit_model("hammerstein", "x", felt, FitOptions(smooth_s=0.0))
    assert fit.model.hammerstein.continues and not fit.warnings
    assert fit.metadata["residual_n"] < 0.01 * forces_n.max()
