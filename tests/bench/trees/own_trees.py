"""Errors of the check that an ensemble saw the features of `ensemble_data`, on the five objects.

python tests/bench/trees/own_trees.py [OBJECT ...]
Counts right ensembles, weak ones too, that are refused, and wrong ones that are taken.
"""

import sys

import numpy as np
from sklearn.ensemble import (
    ExtraTreesRegressor,
    HistGradientBoostingRegressor,
    RandomForestRegressor,
)
from sklearn.preprocessing import MinMaxScaler, StandardScaler

from springpot.codegen.errors import UsageError
from springpot.host.simulation.objects import OBJECTS
from springpot.host.wings.estimators.ensemble import ensemble_data, require_same_data
from springpot.host.wings.evidence.paper.reproduce import Work, simulated

FOREST, EXTRA, BOOSTED = RandomForestRegressor, ExtraTreesRegressor, HistGradientBoostingRegressor
USUAL = {
    "forest": FOREST(5, random_state=0),
    "few rows a tree": FOREST(20, min_samples_leaf=20, max_samples=0.35, random_state=1),
    "extra": EXTRA(5, random_state=0),
    "boosted": BOOSTED(max_iter=30, random_state=0),
}
WEAK = {
    "a stump": EXTRA(1, max_depth=1, random_state=0),
    "depth 1": FOREST(5, max_depth=1, random_state=0),
    "depth 2": FOREST(5, max_depth=2, random_state=0),
    "a feature a split": FOREST(1, max_depth=2, max_features=1, random_state=3),
    "large leaves": FOREST(3, min_samples_leaf=0.1, random_state=0),
    "hundred rows a tree": FOREST(10, max_samples=100, random_state=0),
    "boosted once": BOOSTED(max_iter=1, random_state=0),
    "boosted five times": BOOSTED(max_iter=5, random_state=0),
}
WRONG = {
    "standardised": lambda x: StandardScaler().fit_transform(x),
    "0 to 1": lambda x: MinMaxScaler().fit_transform(x),
    "reversed": lambda x: x[:, ::-1],
    "one order on": lambda x: np.roll(x, 1, axis=1),
    "a thousandth": lambda x: 1e-3 * x,
    "twice": lambda x: 2.0 * x,
    "10 % more": lambda x: 1.1 * x,
}


def refused(ensemble, values, force_n, rows):
    """Tell whether the check refuses an ensemble that was fitted on values."""
    checked, measured_n = rows
    fitted = ensemble.fit(values, force_n)
    try:
        require_same_data(fitted, fitted.predict(checked), checked, measured_n)
    except UsageError:
        return True
    return False


def main(names: list[str]) -> None:
    for name in names or list(OBJECTS)[:5]:
        recordings = simulated(name, "a", Work()).training
        values, force_n = ensemble_data(recordings, seed=1)
        rows = ensemble_data(recordings, fraction=5000 / len(force_n) / 5, seed=2)
        both = {**USUAL, **WEAK}
        right = [k for k, each in both.items() if refused(each, values, force_n, rows)]
        taken = [
            f"{k} {w}"
            for k, each in USUAL.items()
            for w, made in WRONG.items()
            if not refused(each, made(values), force_n, rows)
        ]
        many = len(USUAL) * len(WRONG)
        print(f"{name}: of {len(both)} right ones {len(right)} refused: {right}", flush=True)
        print(f"{name}: of {many} wrong ones {len(taken)} taken: {taken}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
