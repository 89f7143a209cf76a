"""Errors of the check that an ensemble saw the features of `ensemble_data`, on the five objects.

python tests/bench/trees/own_trees.py [OBJECT ...]
Counts right ensembles, weak ones too, that are refused, and wrong ones that are taken.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2]))
from wings.estimators.test_own_trees import OTHER_FEATURES, RIGHT, STRONG

from springpot.codegen.errors import UsageError
from springpot.host.simulation.objects import OBJECTS
from springpot.host.wings.estimators.ensemble import ensemble_data, require_same_data
from springpot.host.wings.evidence.paper.reproduce import Work, simulated


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
        right = [each for each in RIGHT if refused(each, values, force_n, rows)]
        taken = [
            (each, other)
            for each in STRONG
            for other, made in OTHER_FEATURES.items()
            if not refused(each, made(values), force_n, rows)
        ]
        many = len(STRONG) * len(OTHER_FEATURES)
        print(f"{name}: of {len(RIGHT)} right ones {len(right)} refused: {right}", flush=True)
        print(f"{name}: of {many} wrong ones {len(taken)} taken: {taken}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
