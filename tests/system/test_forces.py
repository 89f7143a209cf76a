"""Emission and its forces stay what they were: a change of either shows in the diff."""

import numpy as np
import pytest
from support.c import golden_forces
from support.c.golden_scenes import SCENES, emission, folder_of

KEYS = [("hammerstein", *setting) for setting in golden_forces.SETTINGS]
KEYS += [(name, *setting) for setting in (*golden_forces.EACH_MODE, *golden_forces.SETTINGS)
         for name in golden_forces.models()]  # fmt: skip


@pytest.mark.few(24, 33)
@pytest.mark.parametrize(("name", "number", "mode"), list(dict.fromkeys(KEYS)))
def test_forces_are_the_stored_ones(name: str, number: str, mode: str) -> None:
    key = f"{name} {number} {mode}"
    assert not golden_forces.difference(key, *golden_forces.replayed(name, number, mode))


@pytest.mark.parametrize("name", ["rbf-fd-fast", "hammerstein"])
def test_rounding_of_another_processor_is_no_change_of_force(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    key = f"{name} float64 off"
    for function in ("exp", "expm1"):
        exact = getattr(np, function)
        monkeypatch.setattr(np, function, lambda x, f=exact: np.nextafter(f(x), np.inf))
    force_n, notes = golden_forces.replayed(name, "float64", "off")
    assert golden_forces.force_hash(force_n, notes) != golden_forces.stored()[key]
    assert not golden_forces.difference(key, force_n, notes)
    force_n[1234] += 1e-9
    assert "tick 1234 of" in golden_forces.difference(key, force_n, notes)


@pytest.mark.parametrize("key", ["hammerstein float32 proxy", "rf-fd float64 off"])
def test_stored_forces_are_those_of_the_hashes_and_a_change_is_named(key: str) -> None:
    force_n, notes = golden_forces.stored_forces(key)
    assert golden_forces.force_hash(force_n, notes) == golden_forces.stored()[key]
    force_n[1234] = np.nextafter(force_n[1234], np.inf)
    said = golden_forces.difference(key, force_n, notes)
    assert f"{key}, tick 1234 of" in said and repr(force_n[1234]) in said


@pytest.mark.parametrize("scene", SCENES)
def test_an_emission_is_what_is_checked_in(scene: str) -> None:
    if scene != "smallest_scene" and golden_forces.exp_hash() != golden_forces.stored_exp_hash():
        pytest.skip("decays are printed with other last digits on this processor")
    emitted, folder = emission(scene), folder_of(scene)
    by_hand = {"main.c", "SoftPad.cs"} if scene == "soft_pad" else set()
    assert {path.name for path in folder.iterdir()} == set(emitted) | by_hand
    for name, text in emitted.items():
        stored = (folder / name).read_text()
        assert stored == text, f"{scene}/{name}: run `python -m support.c.golden_scenes`"
