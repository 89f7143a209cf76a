"""Emission and its forces stay what they were: a change of either shows in the diff."""

import pytest
from support.c import golden_forces
from support.c.smallest_scene import FOLDER, smallest_emission

SLOW = {("float32", "tool"), ("float64", "off"), ("float64", "proxy")}


@pytest.mark.parametrize(
    ("number", "mode"),
    [
        pytest.param(*setting, marks=[pytest.mark.slow] if setting in SLOW else [])
        for setting in golden_forces.SETTINGS
    ],
)
@pytest.mark.parametrize("name", golden_forces.models())
def test_forces_are_the_stored_ones(name: str, number: str, mode: str) -> None:
    if golden_forces.exp_hash() != golden_forces.stored_exp_hash():
        pytest.skip("numpy rounds exponentials otherwise on this processor")
    key = f"{name} {number} {mode}"
    assert golden_forces.force_hash(name, number, mode) == golden_forces.stored()[key]


def test_every_kind_of_part_has_a_stored_model() -> None:
    assert len(golden_forces.models()) >= 10
    assert len(golden_forces.stored()) == 1 + 6 * len(golden_forces.models())


def test_the_smallest_scenes_emission_is_what_is_checked_in() -> None:
    emitted = smallest_emission()
    assert sorted(emitted) == sorted(path.name for path in FOLDER.iterdir())
    for name, text in emitted.items():
        assert (FOLDER / name).read_text() == text, f"{name}: run support/c/smallest_scene.py"
