"""An emulated board renders; the host feeds it, validates it, and dies."""

import json
import os
import shutil
import signal
import subprocess
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from support.c.mcu import (
    SLOW_DT_S,
    Relay,
    emulated,
    need,
    slow_model,
    slow_recording,
    target_scene,
)
from support.peer import CLI, cli, wait_until
from support.small import model_file

from springpot.codegen.reference.notes import LATCHED
from springpot.host.boards.boards import BOARDS
from springpot.host.devices.wire import Sender, constant
from springpot.host.emission.checksums import write_checksums
from springpot.host.emission.emission import emit
from springpot.trainer.recordings.recording_file import write_recording

pytestmark = [pytest.mark.board, pytest.mark.slow, pytest.mark.realtime]

SOAK = bool(os.environ.get("SPRINGPOT_SOAK"))
SECONDS = 60.0 if SOAK else 3.0
ONE_OF_EACH = list(BOARDS) if SOAK else ["mps2-an386", "virt"]  # ARM and RISC-V
Emitted = Callable[..., Path]


@pytest.fixture(scope="module")
def emitted(tmp_path_factory: pytest.TempPathFactory) -> Emitted:
    """Folders emitted for a board, each once."""
    root = tmp_path_factory.mktemp("emitted")
    model = model_file(root, slow_model())

    @cache
    def folder_of(target: str) -> Path:
        emit(target_scene(target, mode="proxy"), model, root / target)
        return root / target

    return lambda board: folder_of(BOARDS[board].target)


def command(*arguments: object) -> tuple[int, dict, str]:
    run = cli(*arguments, "--json")
    return run.returncode, json.loads(run.stdout) if run.stdout else {}, run.stderr


@pytest.mark.parametrize("board", list(BOARDS))
def test_validate_compares_every_force_of_the_board(
    tmp_path: Path, emitted: Emitted, board: str
) -> None:
    need(board)
    folder = emitted(board)
    replayed = slow_recording(1.2)
    write_recording(tmp_path / "a.h5", replayed)
    with emulated(folder, board) as port:
        status, found, told = command("validate", folder, "--recording", tmp_path / "a.h5",
                                      "--device", f"serial://{port}")  # fmt: skip
    assert status == 0, told
    assert found["mismatches"] == 0
    assert found["samples"] == len(replayed.force_n)
    assert found["rmse_percent_of_peak"] < 20


@pytest.mark.parametrize("board", ONE_OF_EACH)
def test_the_host_drives_a_board_at_500_hz(tmp_path: Path, emitted: Emitted, board: str) -> None:
    need(board)
    folder = emitted(board)
    write_recording(tmp_path / "feed.h5", slow_recording(SECONDS + 5))
    with emulated(folder, board) as port:
        url = f"serial://{port}?feed={tmp_path / 'feed.h5'}"
        status, ran, told = command("run", "--scene", folder, "--device", url, "--seconds",
                                    SECONDS, "--log", tmp_path / "log.h5")  # fmt: skip
    assert status == 0, told
    assert ran["crc_errors"] == 0 and ran["sequence_gaps"] == 0
    assert ran["ticks"] > 0.8 * ran["expected_ticks"]
    assert ran["samples"] > 0.5 * ran["ticks"]
    status, found, told = command("validate", folder, "--recording", tmp_path / "log.h5")
    assert status == 0, told
    assert found["mismatches"] == 0


def kill_a_host_that_renders(folder: Path, url: str, relay: Relay) -> None:
    """Tries again where the machine stood still for longer than the watchdog waits."""
    for _ in range(8):
        begin = len(relay.calls)
        host = subprocess.Popen([*CLI, "run", "--scene", folder, "--device", url, "--seconds",
                                 "60"], stdout=subprocess.DEVNULL)  # fmt: skip
        try:
            wait_until(
                lambda: any(c["call"] & constant("WAS_RESET") for c in relay.calls[begin:]),  # noqa: B023
                20,
                "no reset",
            )
            wait_until(
                lambda: relay.calls[-1]["force_n"] > 2 or relay.calls[-1]["notes"] & LATCHED,
                20,
                "no force",
            )
            renders = relay.calls[-1]["force_n"] > 2
        finally:
            host.send_signal(signal.SIGKILL)
            host.wait()
        if renders:
            return
    pytest.fail("the watchdog tripped before the host was killed, each time")


@pytest.mark.parametrize("board", ONE_OF_EACH)
def test_a_killed_host_leaves_no_force(tmp_path: Path, emitted: Emitted, board: str) -> None:
    need(board)
    folder = emitted(board)
    write_recording(tmp_path / "feed.h5", slow_recording(60.0, hold=True))
    with emulated(folder, board) as port:
        relay = Relay(port)
        url = f"serial://{relay.port}?feed={tmp_path / 'feed.h5'}"
        kill_a_host_that_renders(folder, url, relay)
        wait_until(lambda: relay.calls[-1]["notes"] & LATCHED, 5, "the watchdog did not trip")
        last = max(i for i, call in enumerate(relay.calls) if not call["call"] & constant("IDLE"))
        wait_until(lambda: len(relay.calls) > last + 100, 5, "the board fell silent")
        forces_n = np.array([call["force_n"] for call in relay.calls[last:]])
        sender = Sender()
        sender.sequence = 1 << 30
        for _ in range(20):  # a host that comes back without a reset is given nothing
            relay.send(sender.encode("feed", position_m=0.01, velocity_mps=0.0))
        wait_until(
            lambda: any(not call["call"] & constant("IDLE") for call in relay.calls[last + 1 :]),
            5,
            "the board took no sample",
        )
        wait_until(lambda: len(relay.calls) > last + 200, 5, "the board fell silent")
        relay.close()
    assert forces_n[0] > 0.5
    zero = int(np.argmax(forces_n == 0))
    assert 0 < zero * SLOW_DT_S <= 0.05
    assert not forces_n[zero:].any()
    after = relay.calls[last + 1 + zero :]
    assert not any(call["force_n"] for call in after)
    # A small force has faded before the watchdog trips; once latched, it stays so.
    latched = [bool(call["notes"] & LATCHED) for call in relay.calls[last:]]
    assert latched.index(True) * SLOW_DT_S <= 0.05
    assert all(latched[latched.index(True) :])


def test_a_board_whose_self_test_fails_renders_nothing(tmp_path: Path, emitted: Emitted) -> None:
    need("mps2-an386")
    folder = emitted("mps2-an386")
    altered = tmp_path / "altered"
    shutil.copytree(folder, altered)
    tables = altered / "sp_regressor.h"
    text = tables.read_text()
    begin = text.index("leaf_step_n = ") + len("leaf_step_n = ")
    tables.write_text(text[:begin] + "2.0f * " + text[begin:])
    write_checksums(altered)  # as if it had been emitted so
    with emulated(altered, "mps2-an386") as port:
        status, _, told = command("run", "--scene", folder, "--device", f"serial://{port}",
                                  "--seconds", 1)  # fmt: skip
    assert status == 5
    assert "the device refuses that action" in told
