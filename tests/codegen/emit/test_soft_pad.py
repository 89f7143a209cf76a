"""The ready C files of examples/soft_pad: a force without Python."""

import subprocess
from pathlib import Path

import numpy as np
from support.c.golden_scenes import folder_of, soft_pad

from springpot.host.native.scene_library import build_and_load

SOFT_PAD = folder_of("soft_pad")


def printed(source: Path, folder: Path) -> str:
    """What a program with the pad prints."""
    flags = ["-std=c11", "-Wall", "-Wextra", "-Werror", f"-I{SOFT_PAD}", "-o", folder / "pad"]
    subprocess.run(["gcc", *flags, source, SOFT_PAD / "soft_pad.c", "-lm"], check=True)
    return subprocess.run([folder / "pad"], check=True, capture_output=True, text=True).stdout


def test_a_compiler_alone_gives_the_forces_of_every_tick(tmp_path: Path) -> None:
    words = [line.split() for line in printed(SOFT_PAD / "main.c", tmp_path).splitlines()]
    depth_m, given_n = (np.array([float(each[k]) for each in words]) for k in (2, 4))
    ticks = 17  # of a sixtieth of a second
    pictures = np.arange(1 - ticks, ticks * (len(words) - 1) + 1) / ticks
    along_m = np.interp(pictures, range(len(words)), 1e-3 * depth_m)
    plan = soft_pad()
    force_n = build_and_load(plan).new_state().run(along_m, np.gradient(along_m, plan.dt_s))[0]
    assert given_n.max() > 3.0 and np.abs(given_n - force_n[ticks - 1 :: ticks]).max() < 2e-3


def test_advance_refuses_misuse(tmp_path: Path) -> None:
    calls = ("0, 0.01f, 0.0f, &n", "&s, 2.0f, 0.0f, &n", "&s, -1.0f, 0.0f, &n")
    refused = " && ".join(f"soft_pad_advance({call}) < 0" for call in calls)
    (tmp_path / "misuse.c").write_text(
        '#include "soft_pad.h"\nint main(void)\n{\nstatic soft_pad_state s;\nfloat n = 7.0f;\n'
        f"soft_pad_init(&s);\nreturn {refused} && n == 7.0f ? 0 : 1;\n}}\n"
    )
    printed(tmp_path / "misuse.c", tmp_path)
