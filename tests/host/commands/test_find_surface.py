"""`springpot record --find-surface`, where there is none; where there is: test_documents.py."""

from pathlib import Path
from typing import Any
from unittest import mock

import pytest
from support.peer import Peer, cli, peer

from springpot.codegen.errors import SpringpotError
from springpot.host.recording import session

PROTOCOL = "[[profile]]\namplitude_n = 2.0\nfrequency_hz = 2.0\n"


def recorded(device: Peer, folder: Path, keys: str = "\n\n\n") -> Any:
    (folder / "one.toml").write_text(PROTOCOL)
    return cli("record", "--device", device.url, "--find-surface", "--protocol",
               folder / "one.toml", "--out", folder / "out", input=keys)  # fmt: skip


@pytest.mark.realtime
def test_a_tool_that_moves_is_no_touch(tmp_path: Path) -> None:
    with peer("serial_device", "--presses-hz", 1) as device:
        result = recorded(device, tmp_path)
    assert result.returncode == 1 and "the tool moved by" in result.stderr
    assert "keep it still" in result.stderr and not (tmp_path / "out").exists()


def test_nobody_there(tmp_path: Path) -> None:
    with peer("serial_device") as device:
        result = recorded(device, tmp_path, keys="")
    assert result.returncode == 2 and "run it in a terminal" in result.stderr


@pytest.mark.parametrize("at_mm", [(0.0, 2.0, 0.0), (2.0, 0.0, 0.0), (0.0, 0.0, 2.0)])
def test_touches_of_other_places_are_no_surface(at_mm: tuple[float, ...]) -> None:
    runner, place_m = mock.MagicMock(), mock.Mock(side_effect=[1e-3 * mm for mm in at_mm])
    runner.return_value.over, runner.return_value.why.return_value = False, ("", None)
    fakes = mock.patch.multiple(session, SessionRunner=runner, _place_m=place_m)
    with fakes, pytest.raises(SpringpotError, match="more than 1 mm from each other"):
        session.find_surface("serial://x", lambda _number: None)
