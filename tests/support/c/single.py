"""Scenes of every stored model, and of what few of them have, to be emitted as one file each."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import cycle
from pathlib import Path
from typing import Any

import numpy as np

from springpot.codegen.emit.files import emit_files
from springpot.codegen.make_plan import make_plan
from springpot.codegen.model.model import Model
from springpot.codegen.model.places import Places
from springpot.codegen.model.regressors import Linear
from springpot.codegen.plan import Plan
from springpot.codegen.scene import Coupling, Guard, Runtime, Scene, Smoothing
from support.c import golden_forces
from support.small import damage, flow, small_model, written_model

# Made of units that others have too.
_ALIKE = {"rf-fd-fast", "rf-fd-quantised"}
_SETTINGS = (("float32", "off"), ("float64", "tool"), ("float32", "proxy"), ("float64", "off"))


def plan_of(
    name: str,
    model: Model,
    number: str,
    mode: str,
    target: str = "host",
    **runtime: Any,
) -> Plan:
    """The plan of a scene whose prefix is its name."""
    scene = Scene(
        schema=1,
        name=name,
        model="x.spm",
        runtime=Runtime(
            number=number,  # type: ignore[arg-type]
            target=target,  # type: ignore[arg-type]
            prefix=name.replace("-", "_"),
            **runtime,
        ),
        coupling=Coupling(mode=mode),  # type: ignore[arg-type]
        smoothing=Smoothing(time_constant_s=8e-4 if mode == "tool" else 0.0),
        guard=Guard(outside="zero" if mode == "proxy" else "fallback"),
    )
    return make_plan(model, scene, accept_unsafe=True)


def every_plan(target: str) -> Iterator[Plan]:
    """Number types and couplings take turns; each unit of the runtime is in one of them."""
    names = [name for name in golden_forces.models() if name not in _ALIKE]
    for name, settings in zip(names, cycle(_SETTINGS), strict=False):
        yield plan_of(name, golden_forces.model(name), *settings, target)
    hammerstein = golden_forces.model("hammerstein")
    passive = hammerstein.hammerstein
    laws = replace(
        passive,
        tau_s=np.array([0.01, 4e3, 0.2, 4e3]),  # two move in double only
        branch_n=np.ones((4, 1)) * passive.elastic_n,
        n_by_depth=2,
        rate_ratio=16.0,
        flow=flow(2.0),
        damage=damage(passive.elastic_n),
        recovers=True,
    )
    law = replace(hammerstein, hammerstein=laws)
    yield plan_of("places", with_map(law), "float32", "off", target)
    yield plan_of("laws", law, "float32", "off", target)
    always = replace(hammerstein, contact="always")
    yield plan_of("velocity", always, "float32", "tool", target)
    linear = replace(small_model(), regressor=Linear(0.5, np.linspace(-1.0, 2.0, 10)))
    yield plan_of("linear", linear, "float32", "off", target)
    if target == "host":
        yield plan_of("written", written_model(), "float32", "off")


def with_map(model: Model) -> Model:
    """An object of two materials, in amounts that differ from place to place."""
    slopes_n = model.hammerstein.slopes_n * np.array([[1.0], [0.5]])
    amounts = np.linspace(0.2, 2.0, 12).reshape(3, 2, 2)
    places = Places(np.array([0.0, -0.01]), np.array([0.01, 0.02]), amounts, slopes_n)
    law = replace(model.hammerstein.with_slopes(places.most_n), places=places)
    return replace(model, hammerstein=law)


def write_single(plan: Plan, folder: Path) -> Path:
    """Write its files into a folder; returns the source, beside which it is as C++ too."""
    for name, text in emit_files(plan).items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    source = folder / f"{plan.scene.runtime.prefix}.c"
    source.with_suffix(".cpp").write_text(source.read_text())
    return source
