"""The error of a scene in its parts: the model's own, and what renders it."""

from dataclasses import replace
from pathlib import Path
from unittest import mock

import numpy as np
import pytest
from support.small import recording, scene, training

from springpot.codegen.arrays import rms
from springpot.codegen.model.model_file import write_model
from springpot.codegen.scene import Coupling
from springpot.host.emission.emission import emit
from springpot.host.validation.store import validation_rows
from springpot.host.validation.validation import Validation, validate
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.predict import limited_n


def validated(folder: Path, mode: str, details: dict[str, object] | None = None) -> Validation:
    """A passive model behind a coupling, replayed on shallower presses than its training."""
    recordings = [replace(item, details=details or {}) for item in training()[:3]]
    accepted = [replace(item, details=details or {}) for item in training()[4:8]]
    model = fit_model("hammerstein", "x", accepted, FitOptions(smooth_s=0.025)).model
    write_model(folder / "m.spm", model)
    chosen = scene(mode=mode)
    if mode == "proxy":
        chosen = replace(chosen, coupling=Coupling("proxy", 500.0, 5.0, 0.05))
    emit(chosen, folder / "m.spm", folder / "c")
    found = validate(folder / "c", recordings, paced_s=0.0)
    pairs = zip(recordings, found.ramped, strict=True)
    errors = [(limited_n(model, item) - item.force_n)[ramp:] for item, ramp in pairs]
    assert found.model_rmse_n == pytest.approx(rms(np.concatenate(errors)), rel=1e-9)
    return found


def test_a_bare_scene_is_its_model(tmp_path: Path) -> None:
    found = validated(tmp_path, "off")
    assert found.rendering_n < found.model_rmse_n
    assert found.accuracy.rmse_n == pytest.approx(found.model_rmse_n, rel=0.1)
    rows = validation_rows(found)
    assert "the hand feels" not in rows["RMSE, the model alone"]
    assert "signs" not in rows
    half = replace(found, notes={"latched": found.accuracy.samples // 2})
    with mock.patch.object(Validation, "felt", ["log"] * 3):
        assert "; 50 % of the ticks, latched" in validation_rows(half)["C against reference"]


def test_the_model_alone_is_judged_on_the_samples_of_the_scene(tmp_path: Path) -> None:
    """Of the same samples, no error is more than the sum of the others."""
    begun = [recording(f"{k}", item.position_m[k:]) for k, item in enumerate(training()[:3], 60)]
    model = fit_model("hammerstein", "x", training()[4:8], FitOptions()).model
    write_model(tmp_path / "m.spm", model)
    emit(scene(), tmp_path / "m.spm", tmp_path / "c")
    found = validate(tmp_path / "c", begun, paced_s=0.0)
    assert all(found.ramped)
    assert sum(found.ramped) == found.accuracy.ramped
    three = sorted((found.accuracy.rmse_n, found.model_rmse_n, found.rendering_n))
    assert three[2] <= (three[0] + three[1]) * (1.0 + 1e-9)
    pairs = zip(begun, found.ramped, strict=True)
    errors = [(limited_n(model, item) - item.force_n)[ramp:] for item, ramp in pairs]
    assert found.model_rmse_n == pytest.approx(rms(np.concatenate(errors)), rel=1e-9)
