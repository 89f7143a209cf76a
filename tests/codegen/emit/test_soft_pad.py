"""The ready C files of examples/soft_pad: a force without Python."""

import subprocess
from pathlib import Path

import numpy as np
import pytest
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
    plan = soft_pad()
    along_m, ends, left_s = [1e-3 * depth_m[0]], [], 0.0
    for to_m in 1e-3 * depth_m:  # sixtieths of a second: 16 or 17 ticks, on a line to the newest
        since_s = left_s + 1.0 / 60.0
        n = int(since_s / plan.dt_s + 1e-3)
        step_m = (to_m - along_m[-1]) * plan.dt_s / since_s
        along_m += [along_m[-1] + tick * step_m for tick in range(1, n + 1)]
        ends.append(len(along_m) - 2)
        left_s = since_s - n * plan.dt_s
    force_n = build_and_load(plan).new_state().run(np.array(along_m[1:]))[0]
    assert len(along_m) == pytest.approx(1000 / 60 * len(words), abs=2)
    assert given_n.max() > 3.0 and np.abs(given_n - force_n[ends]).max() < 2e-3


def test_advance_refuses_misuse(tmp_path: Path) -> None:
    calls = ("0, 0.01f, 0.0f, &n", "&s, 2.0f, 0.0f, &n", "&s, -1.0f, 0.0f, &n")
    refused = " && ".join(f"soft_pad_advance({call}) < 0" for call in calls)
    (tmp_path / "misuse.c").write_text(
        '#include "soft_pad.h"\nint main(void)\n{\nstatic soft_pad_state s;\nfloat n = 7.0f;\n'
        f"soft_pad_init(&s);\nreturn {refused} && n == 7.0f ? 0 : 1;\n}}\n"
    )
    printed(tmp_path / "misuse.c", tmp_path)


def test_a_second_takes_a_second_at_any_frame_rate(tmp_path: Path) -> None:
    """A pressed pad relaxes as fast at 30 as at 5000 frames a second: a frame's rest is kept."""
    (tmp_path / "frames.c").write_text(
        """#include "soft_pad.h"
#include <stdio.h>
int main(void)
{
    const float rates[] = {1000.0f, 30.0f, 59.94f, 144.0f, 400.0f, 987.0f, 2000.0f, 5000.0f};
    for (int i = 0; i < 8; i++) {
        static soft_pad_state s;
        float n = 0.0f, seconds = 0.0f;
        soft_pad_init(&s);
        while (seconds < 0.5f - 0.5f / rates[i]) {
            seconds += 1.0f / rates[i];
            const float press = seconds < 0.1f ? seconds / 0.1f : 1.0f;
            if (soft_pad_advance(&s, 1.0f / rates[i], 0.005f * press, &n) < 0) return 1;
        }
        printf("%.6f\\n", (double)n);
    }
    return 0;
}
""".replace("\\\\", "\\")
    )
    force_n = np.array([float(line) for line in printed(tmp_path / "frames.c", tmp_path).split()])
    held = build_and_load(soft_pad()).new_state()
    at_once_n = held.run(np.append(np.linspace(0.0, 0.005, 100), np.full(50, 0.005)))[0][-1]
    assert at_once_n > 1.05 * force_n[0]  # it relaxes in that time
    np.testing.assert_allclose(force_n, force_n[0], rtol=0.02)
