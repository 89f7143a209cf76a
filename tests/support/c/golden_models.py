"""How the stored models of the forces' test were made: `python -m support.c.golden_models`.

The stored ones were fitted by an earlier version; forces are compared, not fits, so that a fit may
change without them. What this writes is of the same kinds, sizes and engines, from the same
recordings (small.training); golden_forces.py then writes the forces anew.
"""

from springpot.codegen.model.model_file import write_model
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions
from support.c.golden_forces import FOLDER
from support.small import training

_FOREST = {"trees": 4, "leaf": 20}
RECIPES: dict[str, tuple[str, dict[str, object]]] = {
    "hammerstein": ("hammerstein", {}),
    "rbf-fd": ("rbf-fd", {}),
    "rbf-fd-fast": ("rbf-fd", {"engine": "fir-fast"}),
    "rbf-pv": ("rbf-pv", {}),
    "rf-fd": ("rf-fd", _FOREST),
    "rf-fd-fast": ("rf-fd", {**_FOREST, "engine": "fir-fast"}),
    "rf-fd-long": ("rf-fd", {**_FOREST, "engine": "recursive"}),
    "rf-fd-quantised": ("rf-fd", {**_FOREST, "round_features": True}),
    "rf-history-quantised": ("rf-fd", {**_FOREST, "past_positions": True, "round_features": True}),
    "springpot": ("springpot", {}),
}


if __name__ == "__main__":
    for name, (kind, options) in RECIPES.items():
        fitted = fit_model(kind, name, training(), FitOptions(**options))  # type: ignore[arg-type]
        write_model(FOLDER / f"{name}.spm", fitted.model)
