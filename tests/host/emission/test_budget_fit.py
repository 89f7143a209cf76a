"""`emit --fit`: what does not fit a budget is made smaller, measured on recordings."""

import dataclasses
from pathlib import Path

import pytest
from support.small import press, recording, scene, small_fit, small_model

from springpot.codegen.errors import BudgetError, DataError, UsageError
from springpot.codegen.model.model import Model
from springpot.codegen.scene import Budget, Scene
from springpot.host.emission.budget_fit import emit_fitting
from springpot.host.emission.emission import emit
from springpot.host.validation.validation import validate

EVALUATION = recording("judge", press(1.5, 0.011))


@pytest.fixture(scope="module")
def tight(tmp_path_factory: pytest.TempPathFactory) -> tuple[Scene, Model, int]:
    """A scene whose budget is two thirds of what the model takes."""
    folder = tmp_path_factory.mktemp("tight")
    model = small_fit(trees=20).model
    whole = emit(scene(), model, folder / "whole").footprint
    budget = Budget(flash_bytes=2 * whole.flash_bytes // 3)
    return dataclasses.replace(scene(), budget=budget), model, 2 * whole.flash_bytes // 3


@pytest.mark.slow
def test_the_best_forest_that_fits_is_emitted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], tight: tuple[Scene, Model, int]
) -> None:
    chosen, model, flash_bytes = tight
    with pytest.raises(BudgetError, match="--fit --recording REC makes a forest smaller"):
        emit_fitting(chosen, model, tmp_path / "c", False, [EVALUATION], fit=False)
    assert not (tmp_path / "c").exists()
    fitted = emit_fitting(chosen, model, tmp_path / "c", False, [EVALUATION], fit=True)
    assert fitted.footprint.flash_bytes <= flash_bytes
    (line,) = [one for one in capsys.readouterr().err.splitlines() if one.startswith("fitted: ")]
    said_n = float(line.split("RMSE ")[1].split()[0])
    measured = validate(tmp_path / "c", [EVALUATION], paced_s=0.01)
    assert said_n == pytest.approx(measured.accuracy.rmse_n, rel=1e-3)


@pytest.mark.parametrize(
    ("recordings", "fit", "budget", "error", "told"),
    [
        ([dataclasses.replace(EVALUATION, dt_s=2e-3)], True, None, DataError, "500 Hz, the scene"),
        ([], True, None, UsageError, "give --recording REC"),
        ([], False, None, BudgetError, "--fit --recording REC"),
        ([EVALUATION], True, Budget(flash_bytes=100), BudgetError, "no smaller version of this"),
    ],
)
def test_what_cannot_be_fitted_is_refused(
    tmp_path, tight, recordings, fit, budget, error, told
) -> None:
    chosen, model, _ = tight
    if budget:
        chosen, model = dataclasses.replace(chosen, budget=budget), small_model()
    with pytest.raises(error, match=told):
        emit_fitting(chosen, model, tmp_path / "c", False, recordings, fit=fit)
