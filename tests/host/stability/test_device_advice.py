"""Sentences about the figures that a scene states of its device."""

from pathlib import Path
from typing import Any

import pytest
from support.small import model_file

from springpot.codegen.model.model_file import read_model
from springpot.codegen.plan.plan import make_plan
from springpot.codegen.scene import Coupling, Device, Guard, Scene
from springpot.host.stability.device_advice import device_advice

TOOL = Coupling(mode="tool", stiffness_npm=2000.0, damping_nspm=4.0)


@pytest.mark.parametrize(
    ("stated", "coupling", "says"),
    [
        ({}, Coupling(), []),
        ({"max_force_n": 12.0}, Coupling(), []),
        ({"max_force_n": 8.0}, Coupling(), ["may reach 12 N and its device gives 8 N"]),
        ({"velocity_noise_mps": 0.006}, TOOL, []),
        ({"velocity_noise_mps": 0.006}, Coupling(), []),
        ({"velocity_noise_mps": 0.006, "velocity": "device"}, TOOL, ["puts 0.024 N of noise"]),
    ],
)
def test_what_stated_figures_mean(
    tmp_path: Path, stated: dict[str, Any], coupling: Coupling, says: list[str]
) -> None:
    scene = Scene(schema=1, name="pad", model="model.spm", coupling=coupling,
                  guard=Guard(max_force_n=12.0), device=Device(**stated))  # fmt: skip
    plan = make_plan(read_model(model_file(tmp_path)), scene)
    advice = list(device_advice(plan))
    assert len(advice) == len(says)
    for words, said in zip(advice, says, strict=True):
        assert said in words
