"""The scenes that are analysed: every kind, coupling and number type, and what few of them have."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any, Literal, cast

import numpy as np
from support.small import damage, flow, scene, training

from springpot.codegen.emit.files import emit_files
from springpot.codegen.make_plan import make_plan
from springpot.codegen.model.model import Model
from springpot.codegen.model.places import Places
from springpot.trainer.kinds import KINDS, fit_model
from springpot.trainer.models.fit import FitOptions

# Small: what an analysis costs is nodes, taps and ticks that are made up; code is the same.
_OPTIONS = FitOptions(trees=4, leaf=60, n_centers=20, window_s=0.05, orders=(0.1, 0.3, 0.5))
_WATCHDOG_MS = 4.0
# Relaxation by depth, a pole that needs double, a stop, flow, damage, a surface that recovers.
_LAWS: dict[str, Any] = {
    "tau_s": np.array([0.01, 0.2, 4e3, 4e3]),
    "n_by_depth": 2,
    "rate_ratio": 16.0,
    "flow": flow(1.0),
    "recovers": True,
    "radius_m": np.array([1e-3]),
}

Mode = Literal["off", "tool", "proxy"]


@dataclass(frozen=True)
class ProvedScene:
    """One emitted folder; kind: of the model, or what is special of it."""

    kind: str
    coupling: Mode
    number: str
    contact: Literal["surface", "always"] = "surface"

    @property
    def laws(self) -> bool:
        """Whether growth and the latched fall are proven besides."""
        return self in _LAWFUL

    @property
    def name(self) -> str:
        """Of its folder and its row."""
        also = [self.contact] * (self.contact == "always")
        return "-".join([self.kind, self.coupling, self.number, *also])


_LAWFUL = (
    ProvedScene("hammerstein", "off", "float32"),
    ProvedScene("hammerstein", "proxy", "float32"),
    ProvedScene("rf-fd", "tool", "float64"),
)


def proved_scenes() -> Iterator[ProvedScene]:
    """All of them."""
    for kind in (*KINDS, "by-depth", "fir-fast", "past-positions"):
        for coupling in ("off", "tool", "proxy"):
            for number in ("float32", "float64"):
                yield ProvedScene(kind, cast(Mode, coupling), number)
    for coupling, number in (("off", "float32"), ("off", "float64"), ("proxy", "float32")):
        yield ProvedScene("placed", cast(Mode, coupling), number)
    for kind in ("hammerstein", "rbf-pv"):
        yield ProvedScene(kind, "proxy", "float32", contact="always")


def emit_scene(proved: ProvedScene, folder: Path) -> Path:
    """Write its C into folder/NAME; returns that."""
    chosen = scene(number=proved.number, mode=proved.coupling, smoothing_s=8e-4)
    chosen = replace(
        chosen,
        guard=replace(chosen.guard, watchdog_ms=_WATCHDOG_MS),
    )
    model = replace(_model(proved.kind), contact=proved.contact)
    out = folder / proved.name
    out.mkdir(parents=True, exist_ok=True)
    for name, text in emit_files(make_plan(model, chosen, accept_unsafe=True)).items():
        (out / name).write_text(text)
    return out


@cache
def _model(kind: str) -> Model:
    if kind == "fir-fast":
        return fit_model("rbf-fd", "x", training(), replace(_OPTIONS, engine="fir-fast")).model
    if kind == "past-positions":
        return fit_model("rf-fd", "x", training(), replace(_OPTIONS, past_positions=True)).model
    if kind not in ("by-depth", "placed"):
        return fit_model(kind, "x", training(), _OPTIONS).model
    model = _model("hammerstein")
    passive = model.hammerstein
    if kind != "by-depth":
        slopes_n = np.stack([passive.slopes_n, 0.2 * passive.slopes_n])
        amounts = np.random.default_rng(1).uniform(0.0, 1.0, (3, 4, 2))
        places = Places(np.array([-0.01, 0.0]), np.array([0.01, 0.005]), amounts, slopes_n)
        bounded = replace(passive.with_slopes(places.most_n), places=places)
        return replace(model, hammerstein=bounded)
    curve = np.ones_like(passive.elastic_n)
    branch_n = np.linspace(0.1, 0.4, len(_LAWS["tau_s"]))[:, None] * curve
    special = replace(
        passive, branch_n=branch_n, stop_n=0.1 * curve[None, :], damage=damage(curve), **_LAWS
    )
    return replace(model, hammerstein=special)
