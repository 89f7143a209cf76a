"""A folder of firmware: what its user wrote there is never lost."""

from pathlib import Path

import pytest
from support.mcu import need, target_scene
from support.small import model_file

from springpot.codegen.errors import UsageError
from springpot.host.boards.boards import BOARDS
from springpot.host.boards.firmware import TRANSDUCER, build_firmware
from springpot.host.emission.emission import emit

pytestmark = [pytest.mark.board, pytest.mark.slow]
BOARD = "mps2-an386"


def test_the_users_files_stand(tmp_path: Path) -> None:
    need(BOARD)
    emit(target_scene("cortex-m4f"), model_file(tmp_path), tmp_path / "c")
    out = tmp_path / "firmware"

    def build() -> bytes:
        return build_firmware(tmp_path / "c", BOARDS[BOARD], out).read_bytes()

    plain = build()
    assert build() == plain
    own = (out / TRANSDUCER).read_text().replace("return 0;", "*position_m = 1e-3f; return 1;")
    (out / TRANSDUCER).write_text(own)
    changed = build()
    assert changed != plain
    assert (out / TRANSDUCER).read_text() == own
    assert build() == changed
    (out / "sp_port.c").write_text("/* mine */\n" + (out / "sp_port.c").read_text())
    with pytest.raises(UsageError, match=r"sp_port.c: not as springpot emitted it: move your"):
        build()
    assert (out / "sp_port.c").read_text().startswith("/* mine */")


def test_a_folder_of_other_things_is_left_alone(tmp_path: Path) -> None:
    need(BOARD)
    emit(target_scene("cortex-m4f"), model_file(tmp_path), tmp_path / "c")
    (tmp_path / "recordings").mkdir()
    (tmp_path / "recordings" / "a.h5").touch()
    with pytest.raises(UsageError, match="holds files that springpot did not emit"):
        build_firmware(tmp_path / "c", BOARDS[BOARD], tmp_path / "recordings")
    assert len(list((tmp_path / "recordings").iterdir())) == 1
