"""A kind of model from outside: one file and one line of the table take it all the way."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.small import press, recording, scene, training

from springpot import Fit, Recording, emit, predict, read_model, train, validate, write_model
from springpot.codegen.literals import c_literal
from springpot.codegen.model.features import Features
from springpot.codegen.model.model_file import register_part
from springpot.codegen.model.regressors import Regressor
from springpot.codegen.scene import Runtime
from springpot.codegen.stages.stage import (
    Columns,
    FeatureStage,
    Member,
    RegressorStage,
    feature_stage,
    regressor_stage,
)
from springpot.trainer.features import feature_values
from springpot.trainer.kinds import KINDS, Kind
from springpot.trainer.models.fit import FitOptions, assemble
from springpot.trainer.models.passive.passive_fit import fit_passive
from springpot.trainer.models.predict import regressor_force
from springpot.trainer.models.training_set import TrainingSet


@dataclass(frozen=True)
class Depth(Features):
    """The depth itself."""

    exact_at_any_rate = True

    @property
    def n_features(self) -> int:
        return 1

    def memory_s(self, dt_s: float) -> float:
        return 0.0

    def stiffened(self, factor: float) -> tuple["Depth", float]:
        return self, factor


@dataclass(frozen=True)
class Line(Regressor):
    """force = slope_npm x."""

    slope_npm: float

    def on_scaled(self, scale: float) -> "Line":
        return replace(self, slope_npm=self.slope_npm * scale)


@dataclass(frozen=True)
class DepthStage(FeatureStage):
    headers = ()
    members: tuple[Member, ...] = ()
    n_features = 1

    code = """
{% block restart %}{% endblock %}
{% block advance %}{% endblock %}
{% block features %}
    features[0] = clipped_m;
{% endblock %}
"""

    def tables(self) -> list[str]:
        return []

    def reference(self, depth: Any, starts: Any) -> Any:
        return depth[:, None]


@dataclass(frozen=True)
class LineStage(RegressorStage):
    slope: Any
    headers = ()
    code = """
{% block force %}
    const sp_real model_n = slope * features[0];
{% endblock %}
"""

    def tables(self) -> list[str]:
        return [f"static const sp_real slope = {c_literal(self.slope)};"]

    def reference(self, features: Any) -> Any:
        return self.slope * features[:, 0]


def fit_line(
    name: str, data: TrainingSet, options: FitOptions, validation: Sequence[Recording] = ()
) -> Fit:
    rows = data.rows(options.fraction, options.seed)
    x, force_n = data.features(Depth(), rows)[:, 0], data.force_n(rows)
    line = Line(float(x @ force_n / (x @ x)))
    passive = fit_passive(data, options)
    parts = (Depth(), line)
    model = assemble("line", name, data, options, len(rows), parts, passive, False, {})
    return Fit(model, len(rows), 0.0, 0.0)


@feature_stage.register
def depth_stage(features: Depth, kept: Columns, dt_s: float, dtype: type[Any]) -> FeatureStage:
    return DepthStage()


@regressor_stage.register
def line_stage(line: Line, kept: Columns, runtime: Runtime, dtype: type[Any]) -> RegressorStage:
    return LineStage(dtype(line.slope_npm))


@feature_values.register
def depth_values(features: Depth, depth_m: Any, dt_s: float, rows: Any) -> Any:
    return depth_m[rows, None]


@regressor_force.register
def line_force(line: Line, values: Any) -> Any:
    return line.slope_npm * values[:, 0]


register_part(Depth)
register_part(Line)


def test_it_trains_emits_and_validates(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(KINDS, "line", Kind("line", "a straight line", fit_line))
    model = train(training(), "line", "x").model
    file = tmp_path / "line.spm"
    write_model(file, model)
    read = read_model(file)
    tests = [recording("one", press(1.5)), recording("two", press(2.5, 0.006))]
    np.testing.assert_array_equal(
        predict(read, tests[0].position_m), predict(model, tests[0].position_m)
    )
    emission = emit(tmp_path / "c", model=file, scene=replace(scene(), model="line.spm"))
    assert emission.manifest["model"] == "line"
    found = validate(tmp_path / "c", tests, paced_s=0.1)
    assert found.mismatches == 0 and found.accuracy.rmse_n > 0.0
