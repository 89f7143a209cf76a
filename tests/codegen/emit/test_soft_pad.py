"""The ready C files of examples/soft_pad: what emit writes today, and a force without Python."""

import subprocess
from pathlib import Path

import numpy as np
import pytest
from support.c import golden_forces
from support.c.golden_scenes import SOFT_PAD, soft_pad, soft_pad_files

from springpot.host.native.scene_library import built

PROGRAM = [SOFT_PAD / "main.c", SOFT_PAD / "soft_pad.c"]


def test_it_is_what_is_emitted() -> None:
    if golden_forces.exp_hash() != golden_forces.stored_exp_hash():
        pytest.skip("decays are printed with other last digits on this processor")
    for name, text in soft_pad_files().items():
        assert (SOFT_PAD / name).read_text() == text, "run `python -m support.c.golden_scenes`"


def test_a_compiler_alone_gives_the_forces_of_every_tick(tmp_path: Path) -> None:
    program = tmp_path / "pad"
    flags = ["-std=c11", "-Wall", "-Wextra", "-Werror"]
    subprocess.run(["gcc", *flags, "-o", program, *PROGRAM, "-lm"], check=True)
    printed = subprocess.run([program], check=True, capture_output=True, text=True).stdout
    words = [line.split() for line in printed.splitlines()]
    depth_m = np.float32([0.0, *(1e-3 * float(each[2]) for each in words)])
    ticks = 17  # of a sixtieth of a second
    along_m = np.interp(np.arange(1, ticks * len(words) + 1) / ticks, range(len(depth_m)), depth_m)
    plan = soft_pad()
    with built(plan) as library:
        force_n = library.new_state().run(along_m, np.gradient(along_m, plan.dt_s))[0]
    given_n = np.array([float(each[4]) for each in words])
    assert given_n.max() > 3.0
    assert np.abs(given_n - force_n[ticks - 1 :: ticks]).max() < 2e-3


def test_advance_refuses_misuse(tmp_path: Path) -> None:
    calls = ("0, 0.01f, 0.0f, &n", "&s, 2.0f, 0.0f, &n", "&s, -1.0f, 0.0f, &n")
    refused = " && ".join(f"soft_pad_advance({call}) < 0" for call in calls)
    source, program = tmp_path / "misuse.c", tmp_path / "misuse"
    source.write_text(
        '#include "soft_pad.h"\nint main(void)\n{\nstatic soft_pad_state s;\nfloat n = 7.0f;\n'
        f"soft_pad_init(&s);\nreturn {refused} && n == 7.0f ? 0 : 1;\n}}\n"
    )
    command = ["gcc", f"-I{SOFT_PAD}", "-o", program, source, PROGRAM[1], "-lm"]
    subprocess.run(command, check=True)
    subprocess.run([program], check=True)
