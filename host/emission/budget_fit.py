"""Emission within a budget: as it is, or by a smaller version of the model."""

import tempfile
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from springpot.codegen.entry_points import required_part
from springpot.codegen.errors import BudgetError, UsageError
from springpot.codegen.model.model_file import read_model, write_model
from springpot.codegen.plurals import number_of
from springpot.codegen.scene import Scene
from springpot.host.console.output import say
from springpot.host.emission.emission import emit
from springpot.host.emission.result import Emission
from springpot.host.native.toolchain import toolchain
from springpot.trainer.recordings.recording import Recording


def emit_fitting(
    scene: Scene,
    model_file: Path,
    folder: Path,
    accept_unsafe: bool,
    recordings: Sequence[Recording],
    fit: bool,
) -> Emission:
    """Emit; where the scene does not fit its budget, list the best reductions, or apply the best.

    Raises BudgetError, exit status 4, where it does not fit and `fit` is not asked for, or where
    no reduction fits; UsageError for `fit` without recordings; DataError for those of another rate.
    """
    if fit and not recordings:
        raise UsageError("--fit measures what it leaves out: give --recording REC")
    try:
        return emit(scene, model_file, folder, accept_unsafe)
    except BudgetError as error:
        if toolchain(scene.runtime.target) is None:
            raise  # nothing can be measured, of a smaller model neither
        if not recordings:
            raise BudgetError(f"{error}; give --recording REC to see what would fit") from None
        best = required_part("reductions", "--fit, --recording")  # loads what fits need
        emitted = partial(emit, accept_unsafe=accept_unsafe)
        found = best(scene, read_model(model_file), recordings, accept_unsafe, emitted)
        if not found:
            raise BudgetError(
                f"{error}; no reduction of this model fits: use another kind"
            ) from None
        if not fit:
            for reduction in found:
                say(f"would fit: {reduction.line()}")
            would = number_of(len(found), "reduction")
            raise BudgetError(f"{error}; {would} would fit: add --fit") from None
    say(f"fitted: {found[0].line()}")
    with tempfile.TemporaryDirectory(prefix="springpot-") as scratch:
        reduced = Path(scratch) / "model.spm"
        write_model(reduced, found[0].model)
        return emit(scene, reduced, folder, accept_unsafe)
