"""Options that every kind of model is fitted with, and what a fit returns."""

from dataclasses import dataclass, field
from importlib.metadata import version
from math import inf
from typing import Annotated, Literal

from annotated_types import Ge, Interval

from springpot.codegen.messages import short_repr
from springpot.codegen.model.features import Features
from springpot.codegen.model.model import Model
from springpot.codegen.model.passive import Hammerstein
from springpot.codegen.model.regressors import Regressor
from springpot.codegen.types import JsonMapping
from springpot.trainer.models.passive.passive_terms import PASSIVE_POLES
from springpot.trainer.models.training_set import TrainingSet

PAPER_TREES = 100
PAPER_LEAF = 5
PAPER_CENTERS = 100

ACCEPTED_SIGNS = "accepted_signs"  # item of a model's provenance: recordings, by their names

Engine = Literal["fir", "fir-fast", "recursive"]


@dataclass(frozen=True)
class FitOptions:
    """Options of a fit, as `springpot.train` describes each. None: the kind's default.

    >>> FitOptions(trees=50, seed=1)
    FitOptions(seed=1, trees=50)
    """

    seed: Annotated[int, Interval(ge=0, lt=2**32)] = 0
    fraction: Annotated[float, Interval(gt=0, le=1)] | None = None
    window_s: Annotated[float, Interval(gt=0, lt=inf)] | None = None
    smooth_s: Annotated[float, Interval(ge=0, lt=inf)] | None = None
    trees: Annotated[int, Ge(1)] = PAPER_TREES
    leaf: Annotated[int, Ge(1)] = PAPER_LEAF
    # The paper says neither how many rows a tree is fitted on nor how many features a split tries.
    # With a third of the features, leaves follow features that lag behind the force, and up to 15
    # of 30 small-signal cells of the forest were active; with all of them none. Few rows a tree
    # make up for the time and halve the nodes.
    tree_rows: Annotated[float, Interval(gt=0, le=1)] = 0.35
    split_features: Annotated[float, Interval(gt=0, le=1)] = 1.0
    n_centers: Annotated[int, Ge(1)] = PAPER_CENTERS
    velocity_weight: Annotated[float, Interval(gt=0, le=1)] = 1.0
    select: Literal["cv", "paper"] = "cv"
    engine: Engine | None = None
    round_features: bool = False
    past_positions: bool = False
    orders: tuple[Annotated[float, Interval(ge=0, le=1)], ...] | None = None
    poles: Annotated[int, Ge(1)] = PASSIVE_POLES
    accept_misfit: bool = False
    __repr__ = short_repr


@dataclass(frozen=True, eq=False)
class Fit:
    """A fitted model and what it took: seconds for features, fit and search; further metadata.

    >>> train(recordings, "hammerstein", "pad").model.name
    'pad'
    """

    model: Model
    rows: int
    feature_s: float
    fit_s: float
    search_s: float = 0.0
    metadata: JsonMapping = field(default_factory=dict)
    warnings: tuple[str, ...] = ()

    def __repr__(self) -> str:
        seconds = self.feature_s + self.fit_s + self.search_s
        return f"Fit({self.model!r}, {self.rows} rows, {seconds:.3g} s)"


def assemble(
    kind: str,
    name: str,
    data: TrainingSet,
    options: FitOptions,
    rows: int,
    parts: tuple[Features | None, Regressor | None],
    passive: Hammerstein,
    adds: bool,
    metadata: JsonMapping,
) -> Model:
    """Put a model together with its provenance.

    kind, name: of the model; kind as its entry point. rows: samples that it was fitted on. parts:
    features and a regressor on them, or (None, None). passive: of `fit_passive`; adds: its force
    is part of the model's, else it renders depths beyond the trained one alone. metadata: JSON
    values, further provenance.
    """
    accepted = [recording.name for recording in data.recordings if recording.signs_accepted]
    return Model(
        kind=kind,
        name=name,
        dt_s=data.dt_s,
        contact=data.contact,
        trained=data.trained,
        features=parts[0],
        regressor=parts[1],
        hammerstein=passive,
        hammerstein_adds=adds,
        provenance={
            "seed": options.seed,
            "rows": rows,
            "rows_total": data.rows_total,
            "longest_s": data.longest_s,
            "smooth_s": data.smooth_s,
            "zero": data.recordings[0].zero,
            "recordings": _hash_recordings(data),
            "scikit-learn": version("scikit-learn"),
            "springpot": version("springpot"),
            **({ACCEPTED_SIGNS: accepted} if accepted else {}),
            **metadata,
        },
    )


def _hash_recordings(data: TrainingSet) -> dict[str, str]:
    """Content of each recording by its name; folders may hold the same names."""
    hashes: dict[str, str] = {}
    for recording in data.recordings:
        name, count = recording.name, 1
        while name in hashes:
            count += 1
            name = f"{recording.name} ({count})"
        hashes[name] = recording.content_hash
    return hashes
