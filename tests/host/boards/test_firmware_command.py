"""The firmware's protocol on this machine, with a small scene: what a command may do, and when."""

import zlib
from dataclasses import dataclass

import numpy as np
import pytest
from support.paths import C_TESTS, TESTS

from springpot.host.devices.wire import Sender, constant, layout
from springpot.host.native.c_library import CLibrary
from springpot.host.native.compiler import shared_library
from springpot.runtime_c.paths import INCLUDE, PORT_MCU, PORT_WIRE

STUB = TESTS / "support" / "stubs" / "firmware"
DECLARATIONS = """
typedef struct { const uint8_t *bytes; const uint32_t *counts, *periods;
                 int32_t *resets, *running, *acks, *steps; float *force_n, *rendered_n;
                 uint32_t n; } script;
void harness_run(const script *);
"""
STOP, START, RESET, PRESS, REPLAY = (
    constant(name) for name in ("STOP", "START", "RESET", "PRESS", "REPLAY")
)
WATCHDOG = 20  # periods


@pytest.fixture(scope="module")
def library() -> CLibrary:
    sources = [C_TESTS / "firmware_harness.c", PORT_WIRE / "sp_wire.c"]
    # The harness includes it: built anew where it changed.
    included = zlib.crc32((PORT_MCU / "sp_firmware.c").read_bytes())
    folders = [STUB, PORT_MCU, PORT_WIRE, INCLUDE]
    built = shared_library(sources, folders, [f"-DTEST_OF_FIRMWARE={included}u"])
    return CLibrary(built, DECLARATIONS)


def ask() -> bytes:
    return Sender().encode("ask", layout=layout())


def command(sequence: int, action: int) -> bytes:
    sender = Sender()
    sender.sequence = sequence % (1 << 32)
    return sender.encode("command", action=action, watchdog_s=1.0, rate_hz=1000.0)


def feed(sequence: int) -> bytes:
    sender = Sender()
    sender.sequence = sequence % (1 << 32)
    return sender.encode("feed", position_m=1e-3, velocity_mps=0.0)


@dataclass
class After:
    """What the firmware is after each pass."""

    resets: np.ndarray
    running: np.ndarray
    acks: np.ndarray
    steps: np.ndarray  # since the last reset
    force_n: np.ndarray
    rendered_n: np.ndarray  # as the last call told


def run(library: CLibrary, passes: list[tuple[bytes, int]]) -> After:
    """Let the firmware take these bytes, then so many periods, pass by pass."""
    n = len(passes)
    after = After(*(np.zeros(n, dtype=kind) for kind in ("i4", "i4", "i4", "i4", "f4", "f4")))
    given = {
        "bytes": np.frombuffer(b"".join(content for content, _ in passes) + b"\0", "u1"),
        "counts": np.array([len(content) for content, _ in passes], "u4"),
        "periods": np.array([periods for _, periods in passes], "u4"),
        **vars(after),
    }
    kinds = {"u1": "uint8_t[]", "u4": "uint32_t[]", "i4": "int32_t[]", "f4": "float[]"}
    pointers = {name: library.ffi.from_buffer(kinds[values.dtype.str[1:]], values)
                for name, values in given.items()}  # fmt: skip
    library.c.harness_run(library.ffi.new("script *", {**pointers, "n": n}))
    return after


@pytest.mark.parametrize("first", [0, (1 << 32) - 3, 1 << 31])
def test_a_press_begins_and_its_latch_is_taken_back_by_a_reset(
    library: CLibrary, first: int
) -> None:
    passes = [(ask() + command(first, START), 1), (feed(first + 1), 1), (b"", WATCHDOG + 1),
              (feed(first + 2), 5), (command(first + 3, RESET), 1), (feed(first + 4), 1),
              (command(first + 5, STOP), 1)]  # fmt: skip
    after = run(library, passes)
    assert after.resets.tolist() == [1, 1, 1, 1, 2, 2, 2]
    assert after.running.tolist() == [1, 1, 1, 1, 1, 1, 0]
    assert after.force_n.tolist() == [1, 1, 0, 0, 1, 1, 0]


@pytest.mark.parametrize("seed", range(100))
def test_a_command_acts_once_whatever_comes_again_or_late(library: CLibrary, seed: int) -> None:
    """Random orders of a host's frames, repeated and late ones among them; ASK only where it opens.

    A reset is by a RESET or REPLAY that is later than all before it, or by the START of a host that
    has asked, or after STOP. Every whole command is acknowledged, and any STOP stops.
    """
    rng = np.random.default_rng(seed)
    base = int(rng.integers(0, 1 << 32))
    sequence, running, asked, resets, acks = base + 1, True, False, 1, 1
    newest: int | None = base  # of those that acted since a host asked
    sent: list[tuple[int, int]] = [(base, START)]
    passes, wanted = [(ask() + command(base, START), 1)], [(1, 1, 1)]
    for _ in range(60):
        what = rng.integers(0, 10)
        content = b""
        if what == 0:  # the host opens it anew, and goes on counting
            content, asked, sent, newest = ask(), True, [], None
        elif what < 6 and (what < 3 or sent):
            if what < 3:
                sent.append((sequence, int(rng.choice([START, RESET, PRESS, REPLAY, STOP]))))
                sequence += 1
                number, action = sent[-1]
            else:
                number, action = sent[int(rng.integers(0, len(sent)))]
            content, acks = command(number, action), acks + 1
            if action == STOP:
                running = False
            elif (newest is None or number > newest) and (
                action in (RESET, REPLAY) or asked or not running
            ):
                newest, asked, resets = number, False, resets + 1
                running = running or action != RESET
        else:
            content, sequence = feed(sequence), sequence + 1
        passes.append((content, int(rng.integers(0, 8))))
        wanted.append((resets, int(running), acks))
    after = run(library, passes)
    found = list(zip(after.resets.tolist(), after.running.tolist(), after.acks.tolist(),
                     strict=True))  # fmt: skip
    assert found == wanted


@pytest.mark.parametrize("pause", [0, 1, WATCHDOG + 1, 10 * WATCHDOG])
def test_a_replay_is_a_call_for_each_feed_without_a_force_in_the_motor(
    library: CLibrary, pause: int
) -> None:
    """However long the host waits between motions; a session after it idles again, and latches."""
    feeds = feed(10) + feed(11)
    passes = [(ask() + command(5, START), 1), (feed(6), 1), (command(7, REPLAY), pause)]
    passes += [(feed(8), pause), (feed(9), pause), (feeds, pause)]
    passes += [(command(12, RESET), 1), (feed(13), 1), (b"", WATCHDOG + 1)]
    after = run(library, passes)
    assert after.force_n.tolist() == [1, 1, 0, 0, 0, 0, 1, 1, 0]
    assert after.steps.tolist() == [0, 1, 0, 1, 2, 4, 0, 1, 1]
    assert after.rendered_n.tolist() == [1, 1, 1, 1, 1, 1, 1, 1, 0]
