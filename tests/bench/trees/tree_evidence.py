"""Options of the tree models: active small-signal cells, error and tick time on the five objects.

python tests/bench/trees/tree_evidence.py [OBJECT ...]
"""

import sys
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from sklearn.ensemble import (
    ExtraTreesRegressor,
    HistGradientBoostingRegressor,
    RandomForestRegressor,
)

from springpot.codegen.model.regressors import Forest
from springpot.codegen.plan.make_plan import make_plan
from springpot.codegen.scene import Coupling, Scene
from springpot.host.native.replay import Replay
from springpot.host.native.trial_build import built
from springpot.host.simulation.objects import OBJECTS
from springpot.host.stability.small_signal import small_signal_map
from springpot.host.wings.evidence.paper.reproduce import Work, simulated
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from springpot.trainer.models.forests import (
    FEATURES_AT_SPLIT,
    ROWS_OF_A_TREE,
    boosted_ir,
    depth_scale,
    forest_ir,
)
from springpot.trainer.models.training_set import training_set

THIRD = 1 / 3  # of the features at each split
Fitted = Callable[[np.ndarray, np.ndarray, float], Forest]


def ensemble(kind: Any = RandomForestRegressor, leaf: int = 5, **options: Any) -> Fitted:
    options = {"max_features": THIRD, **options}

    def fit(x: np.ndarray, y: np.ndarray, scale: float) -> Forest:
        regressor = kind(
            random_state=0, n_jobs=-1, n_estimators=100, min_samples_leaf=leaf, **options
        )
        return forest_ir(regressor.fit((scale * x).astype(np.float32), y)).on_scaled(scale)

    return fit


def shrunk(leaf: int, weight: float) -> Fitted:
    """Leaves drawn to their ancestors' means (hierarchical shrinkage, Agarwal et al. 2022)."""

    def fit(x: np.ndarray, y: np.ndarray, scale: float) -> Forest:
        regressor = RandomForestRegressor(
            100, min_samples_leaf=leaf, max_features=THIRD, random_state=0, n_jobs=-1
        ).fit((scale * x).astype(np.float32), y)
        for estimator in regressor.estimators_:
            tree = estimator.tree_
            mean = tree.value[:, 0, 0].copy()
            value = mean.copy()
            for node in range(tree.node_count):
                for child in (tree.children_left[node], tree.children_right[node]):
                    if child >= 0:
                        step = mean[child] - mean[node]
                        value[child] = value[node] + step / (
                            1.0 + weight / tree.weighted_n_node_samples[node]
                        )
            tree.value[:, 0, 0] = value
        return forest_ir(regressor).on_scaled(scale)

    return fit


def boosted(monotone_from: int) -> Fitted:
    """Boosted trees, monotone in the orders from this column on."""

    def fit(x: np.ndarray, y: np.ndarray, scale: float) -> Forest:
        regressor = HistGradientBoostingRegressor(
            max_iter=100, max_depth=4, random_state=0, early_stopping=False,
            monotonic_cst=[int(i >= monotone_from) for i in range(x.shape[1])],
        ).fit((scale * x).astype(np.float32), y)  # fmt: skip
        return boosted_ir(regressor).on_scaled(scale)

    return fit


OPTIONS: dict[str, Fitted] = {
    "forest: third of the features": ensemble(),
    "forest: all features": ensemble(max_features=1.0),
    "forest: all features; 35 % of rows a tree (the default)": ensemble(
        max_features=FEATURES_AT_SPLIT, max_samples=ROWS_OF_A_TREE
    ),
    "forest: third; leaf 20": ensemble(leaf=20),
    "forest: third; leaf 80": ensemble(leaf=80),
    "forest: third; shrunk 50": shrunk(5, 50.0),
    "forest: third; monotone": ensemble(monotonic_cst=[1] * 10),
    "forest: all features; monotone": ensemble(max_features=1.0, monotonic_cst=[1] * 10),
    "extra trees: third": ensemble(ExtraTreesRegressor),
    "boosted": boosted(10),
    "boosted; monotone from order 0.3 on": boosted(5),
    "boosted; monotone": boosted(0),
}


def main(names: list[str]) -> None:
    print("object,option,active cells of 30,RMSE N,of the first,tick ns,nodes")
    scene = Scene(schema=1, name="x", model="x", coupling=Coupling(mode="off"))
    for name in names:
        data = simulated(name, "a", Work())
        options = FitOptions()
        plain = fit_model("rf-fd", name, data.training, options).model
        rows_of = training_set(data.training, options.smooth_s)
        rows = rows_of.rows(options.fraction, options.seed)
        x, y = rows_of.features(plain.features, rows), rows_of.force_n(rows)
        scale = depth_scale(plain.trained.max_m)
        first_n = np.nan
        for option, fit in OPTIONS.items():
            forest = fit(x, y, scale)
            plan = make_plan(replace(plain, regressor=forest), scene)
            with built(plan) as library:
                active, _ = small_signal_map(plan, library, 0).active(False)
                errors = [
                    np.sqrt(
                        np.mean((library.new_state().run(rec.position_m)[0] - rec.force_n) ** 2)
                    )
                    for rec in data.validation
                ]
                rec = data.validation[0]
                ticks = Replay(library).tick_times(
                    rec.position_m, np.zeros_like(rec.position_m), plan.dt_s, 0.2
                )
            rmse_n = float(np.mean(errors))
            first_n = rmse_n if np.isnan(first_n) else first_n
            print(
                f"{name},{option},{active},{rmse_n:.3f},{rmse_n / first_n:.2f},"
                f"{ticks.hot_median:.0f},{len(forest.feature)}",
                flush=True,
            )


if __name__ == "__main__":
    main(sys.argv[1:] or list(OBJECTS))
