"""Features and fit of every kind on the paper's protocol, beside scikit-learn's default forest.

python tests/bench/modelling_time.py [OBJECT]: seconds, and ratios to a forest of 100 trees, 5
samples in a leaf, all features at a split, one job, on the same rows in the same run.
"""

import sys
import time

import numpy as np
from sklearn.ensemble import RandomForestRegressor

from springpot.host.wings.evidence.paper.reproduce import Work, simulated
from springpot.trainer.ensemble import ensemble_data
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions

KINDS = ("rf-fd", "rbf-fd", "rbf-pv", "rf-history", "boosted", "hammerstein", "hybrid", "springpot")
RUNS = 3


def default_forest_s(recordings: tuple) -> tuple[float, int]:
    begin = time.perf_counter()
    values, force_n = ensemble_data(recordings)
    RandomForestRegressor(100, min_samples_leaf=5, random_state=0).fit(values, force_n)
    return time.perf_counter() - begin, len(values)


def main(name: str = "ecoflex-00-30") -> None:
    recordings = simulated(name, "a", Work(signals=1)).training
    forest_s: list[float] = []
    seconds: dict[str, list[tuple[float, float, float]]] = {kind: [] for kind in KINDS}
    rows: dict[str, int] = {}
    for _ in range(RUNS):  # interleaved: other work on the machine meets all of them
        taken_s, forest_rows = default_forest_s(recordings)
        forest_s.append(taken_s)
        for kind in KINDS:
            begin = time.perf_counter()
            fit = fit_model(kind, name, recordings, FitOptions())
            all_s = time.perf_counter() - begin
            seconds[kind].append((fit.feature_s + fit.fit_s, fit.search_s, all_s))
            rows[kind] = fit.rows
    base_s = float(np.median(forest_s))
    print(f"{name}: scikit-learn's default forest {base_s:.2f} s on {forest_rows} rows")
    print("kind           rows  model s  search s   all s  model ratio  all ratio")
    for kind, runs in seconds.items():
        model_s, search_s, all_s = np.median(runs, axis=0)
        print(f"{kind:12} {rows[kind]:6d} {model_s:8.2f} {search_s:9.2f} {all_s:7.2f} "
              f"{model_s / base_s:12.3f} {all_s / base_s:10.3f}")  # fmt: skip


if __name__ == "__main__":
    main(*sys.argv[1:])
