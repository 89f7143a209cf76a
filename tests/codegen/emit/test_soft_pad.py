"""The ready C files of examples/soft_pad: a force without Python."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from support.c import golden_forces
from support.c.golden_scenes import folder_of, soft_pad
from support.paths import ROOT

from springpot.codegen.make_plan import make_plan
from springpot.host.native.scene_library import SceneLibrary, build_and_load
from springpot.host.stability.linear import margin_sentence, plan_margin

SOFT_PAD = folder_of("soft_pad")
HELD, LATCHED, TIME_STEP = 1, 32, -2


def printed(source: Path, folder: Path) -> str:
    """What a program with the pad prints."""
    flags = ["-std=c11", "-Wall", "-Wextra", "-Werror", f"-I{SOFT_PAD}", "-o", folder / "pad"]
    subprocess.run(["gcc", *flags, source, SOFT_PAD / "soft_pad.c", "-lm"], check=True)
    return subprocess.run([folder / "pad"], check=True, capture_output=True, text=True).stdout


def test_a_compiler_alone_gives_the_forces_of_every_tick(tmp_path: Path) -> None:
    words = [line.split() for line in printed(SOFT_PAD / "main.c", tmp_path).splitlines()]
    depth_m, given_n = (np.array([float(each[k]) for each in words]) for k in (2, 4))
    plan = soft_pad()
    along_m, ends, left_s = [-float(plan.guard.max_step_m)], [], 0.0  # from above
    for to_m in 1e-3 * depth_m:  # sixtieths of a second: 16 or 17 ticks, on a line to the newest
        since_s = left_s + 1.0 / 60.0
        n = int(since_s / plan.dt_s + 1e-3)
        step_m = (to_m - along_m[-1]) * plan.dt_s / since_s
        along_m += [along_m[-1] + tick * step_m for tick in range(1, n + 1)]
        ends.append(len(along_m) - 1)
        left_s = since_s - n * plan.dt_s
    force_n = build_and_load(plan).new_state().run(np.array(along_m))[0]
    assert len(along_m) == pytest.approx(1000 / 60 * len(words), abs=2)
    assert given_n.max() > 3.0 and np.abs(given_n - force_n[ends]).max() < 2e-3


class Pad:
    """A state behind sp_advance."""

    def __init__(self, library: SceneLibrary) -> None:
        self._advance, self._kept = library.function("advance"), library.new_state()
        to_state = library.loaded.ffi.typeof(self._advance).args[0]
        self._state = library.loaded.ffi.cast(to_state, self._kept.address)
        self._force_n = library.loaded.ffi.new(f"{library.real} *", 7.0)

    def advance(self, seconds: float, position_m: float) -> tuple[float, int]:
        notes = self._advance(self._state, seconds, position_m, self._force_n)
        return self._force_n[0], notes


@pytest.fixture(scope="module")
def library() -> SceneLibrary:
    return build_and_load(soft_pad())


def test_advance_refuses_misuse(library: SceneLibrary) -> None:
    pad = Pad(library)
    assert pad.advance(-1e-3, 0.0) == pad.advance(np.nan, 0.0) == (7.0, TIME_STEP)
    advance, force_n = library.function("advance"), library.loaded.ffi.new("float *")
    assert advance(library.loaded.ffi.NULL, 0.01, 0.0, force_n) == -1
    zeros = library.loaded.memory(library.state_bytes, "soft_pad_state")
    assert advance(zeros, 0.01, 0.0, force_n) == -3


CURSOR_M = (np.nan, np.inf, -np.inf, 3e38, -3e38, -11.0, -0.5, -0.1, 0.001, 0.01, 0.15, 0.5)


@pytest.mark.parametrize("name", ["hammerstein", "rbf-fd", "springpot"])
@pytest.mark.parametrize("mode", ["off", "tool", "proxy"])
def test_a_cursor_that_jumps_anywhere_never_ends_the_force(name: str, mode: str) -> None:
    """At any frame rate, through the wall, off the screen, from what is no number."""
    scene = golden_forces.scene(name, "float32", mode)
    plan = make_plan(golden_forces.model(name), scene, accept_unsafe=True)
    library, random = build_and_load(plan), np.random.default_rng(1)
    for seconds in (1 / 400, 1 / 60, 1 / 30, 0.3, 5.0, np.inf):
        pad = Pad(library)
        for position_m in random.choice(CURSOR_M, 60):
            force_n, notes = pad.advance(seconds, position_m)
            assert 0.0 <= force_n <= plan.max_force_n and notes >= 0
            assert not notes & LATCHED and bool(notes & HELD) == np.isnan(position_m)
        pad.advance(1.0, -1.0)  # away, at once
        assert pad.advance(1e-3, -1.0) == (0.0, 0)
        assert pad.advance(0.1, 0.011)[0] > 0.2  # below the dent that a springpot keeps


def test_a_deep_cursor_presses_as_at_the_trained_depth(library: SceneLibrary) -> None:
    pad, other = Pad(library), Pad(library)
    for each in (pad, other):
        each.advance(0.01, -0.01)
    for depth_m in (0.05, 0.2, 5.0, np.inf):
        assert pad.advance(0.2, depth_m)[0] == other.advance(0.2, soft_pad().range.max_m)[0] > 9.0
    assert pad.advance(0.2, -0.2)[0] == 0.0
    given_n, notes = pad.advance(1 / 30, np.nan)  # held where it is
    assert (given_n, notes) == (0.0, HELD)


def test_the_page_names_the_pad_s_limits() -> None:
    page = (ROOT / "docs" / "how-to" / "game-engine.md").read_text()
    plan = soft_pad()
    assert f"({1e3 * plan.range.max_m:.1f} mm of the ready pad)" in page
    assert f"({plan.guard.max_step_m / plan.dt_s:.1f} m/s here)" in page
    times = re.search(r"up to (\d+) times", margin_sentence(plan_margin(plan)))
    assert f"stable in every hand up to {times[1]} times its stiffness" in page


def test_a_pad_that_is_touched_before_it_is_seen_relaxes(library: SceneLibrary) -> None:
    """A game that calls only while something touches: the tool came from above, in that picture."""
    touched, seen = Pad(library), Pad(library)
    seen.advance(0.1, -0.01)
    first_n, later_n = touched.advance(1 / 60, 0.010)[0], touched.advance(1.0, 0.010)[0]
    assert first_n > later_n > 3.0
    assert seen.advance(1 / 60, 0.010)[0] == pytest.approx(first_n, rel=0.02)
    assert seen.advance(1.0, 0.010)[0] == pytest.approx(later_n, rel=0.01)


def test_a_hitch_longer_than_a_second_is_a_second(library: SceneLibrary) -> None:
    one, long = Pad(library), Pad(library)
    for pad in (one, long):
        pad.advance(0.1, 0.008)
    assert one.advance(1.0, 0.008) == long.advance(60.0, 0.008)


RATES = (1000, 30, 60, 75, 100, 150, 400, 2000, 5000)  # frames a second
IN_C = """#include "soft_pad.h"
#include <stdio.h>
int main(void)
{
    const int rates[] = {RATES};
    for (int i = 0; i < (int)(sizeof(rates) / sizeof(rates[0])); i++) {
        static soft_pad_state s;
        float n = 0.0f, begin = 0.0f;
        soft_pad_init(&s);
        for (int frame = 0; frame <= rates[i] * 6 / 5; frame++) { /* at first in the air */
            const float seconds = (float)frame / (float)rates[i];
            const float depth = 0.005f * (seconds < 0.1f ? seconds / 0.1f : 1.0f);
            if (soft_pad_advance(&s, 1.0f / (float)rates[i], depth, &n) < 0) return 1;
            if (frame == rates[i] / 5) begin = n;
        }
        printf("%.6f %.6f\\n", (double)begin, (double)(begin - n));
    }
    return 0;
}
"""
IN_CSHARP = """using System;
static class Frames
{
    static void Main()
    {
        foreach (int rate in new[] {RATES})
        {
            using (Point pad = new Point())
            {
                float n = 0.0f, begin = 0.0f;
                for (int frame = 0; frame <= rate * 6 / 5; frame++)  // at first in the air
                {
                    float depth = 0.005f * Math.Min(frame / (0.1f * rate), 1.0f);
                    n = pad.Advance(1.0f / rate, depth);
                    if (frame == rate / 5) begin = n;
                }
                Console.WriteLine("{0:F6} {1:F6}", begin, begin - n);
            }
        }
    }
}
"""


def require_one_time(lines: str) -> None:
    """Force after 0.2 s, and what it has lost 1 s later: the same at every rate, to 2 %."""
    begin_n, lost_n = np.array([line.split() for line in lines.splitlines()], dtype=float).T
    assert len(lost_n) == len(RATES) and lost_n[0] > 0.05 * begin_n[0]
    np.testing.assert_allclose(begin_n, begin_n[0], rtol=0.02)
    np.testing.assert_allclose(lost_n, lost_n[0], rtol=0.02)


def test_a_second_takes_a_second_at_any_frame_rate(tmp_path: Path) -> None:
    """A pressed pad relaxes as fast at 30 as at 5000 frames a second: a frame's rest is kept."""
    (tmp_path / "frames.c").write_text(IN_C.replace("RATES", ", ".join(map(str, RATES))))
    require_one_time(printed(tmp_path / "frames.c", tmp_path))


@pytest.mark.skipif(shutil.which("mcs") is None, reason="no mono-mcs")
def test_a_second_takes_a_second_in_c_sharp(tmp_path: Path) -> None:
    """SoftPad.cs with another program beside it; its own says what the page shows."""
    (tmp_path / "Frames.cs").write_text(IN_CSHARP.replace("RATES", ", ".join(map(str, RATES))))
    library = ["gcc", "-O2", "-shared", "-fPIC", "-o", "libsoft_pad.so", SOFT_PAD / "soft_pad.c"]
    subprocess.run([*library, "-lm"], cwd=tmp_path, check=True)
    found = {}
    for main in ("Frames", "Program"):
        sources = [SOFT_PAD / "SoftPad.cs", "Frames.cs"]
        subprocess.run(["mcs", f"-main:{main}", "-out:a.exe", *sources], cwd=tmp_path, check=True)
        environment = {**os.environ, "LD_LIBRARY_PATH": str(tmp_path), "LC_ALL": "C"}
        found[main] = subprocess.run(["mono", "a.exe"], cwd=tmp_path, check=True, text=True,
                                     capture_output=True, env=environment).stdout  # fmt: skip
    require_one_time(found["Frames"])
    assert "drawn " in found["Program"]
