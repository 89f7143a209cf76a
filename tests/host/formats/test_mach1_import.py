"""Mach-1 text files -> one recording a sinusoid block."""

from pathlib import Path

import numpy as np
import pytest
from support.messages import refusing

from springpot.codegen.errors import DataError, UsageError
from springpot.trainer.recordings.formats.column_map import parse_map
from springpot.trainer.recordings.formats.importing import ImportOptions, ImportResult, import_file

INFO = """<Mach-1 File>
<INFO>
Time:\t10:08:47.546
Load Cell Low-pass filter:\tYes
Load Cell Low-pass filter Order:\t3
Load Cell Low-pass filter Cutoff frequency (Hz):\t20.00
<END INFO>
"""
SINUSOID = """<Sinusoid>
Stage Axis:\tPosition (z)
Amplitude, mm:\t0.5
Frequency, Hz:\t0.50000
Number of Cycles:\t20
<DATA>
Time, s\tPosition (z), mm\tFz, gf
0.00\t1.0\t100.0
0.01\t1.5\t200.0
0.02\t2.0\t300.0
<END DATA>
"""


def load(path: Path, text: str) -> ImportResult:
    file = path / "run.txt"
    file.write_bytes(text.replace("\n", "\r\n").encode())
    return import_file(file, None, "none", None)


def test_units_and_details(tmp_path: Path) -> None:
    (recording,) = load(tmp_path, INFO + SINUSOID).recordings
    assert recording.name == "run-0.5Hz"
    np.testing.assert_allclose(recording.position_m, [1.0e-3, 1.5e-3, 2.0e-3], rtol=1e-15)
    np.testing.assert_allclose(recording.force_n, [0.980665, 1.96133, 2.941995], rtol=1e-15)
    assert recording.dt_s == 0.01
    assert recording.details.pop("sampling")["median_step_s"] == 0.01
    force = {"unit": "gf", "to_si": 9.80665e-3, "from": "header", "column": "Fz"}
    assert recording.details.pop("units")["force"] == force
    assert recording.details == {
        "block": "Sinusoid",
        "frequency_hz": 0.5,
        "amplitude_m": 0.5e-3,
        "cycles": 20,
        "load_cell_low_pass_order": 3,
        "load_cell_low_pass_hz": 20.0,
    }


def test_blocks_of_one_frequency_get_two_names(tmp_path: Path) -> None:
    result = load(tmp_path, INFO + SINUSOID + SINUSOID)
    assert [recording.name for recording in result.recordings] == ["run-0.5Hz", "run-0.5Hz-2"]


TABLE = SINUSOID[SINUSOID.index("<DATA>") :]


def test_every_kind_of_block_with_samples(tmp_path: Path) -> None:
    blocks = "".join(f"<{kind}>\nVelocity, mm/s:\t0.1\n{TABLE}" for kind in (
        "Find Contact", "Move Relative", "Normal Indentation", "Scripts"))  # fmt: skip
    blocks += "<Wait>\nTime, s:\t3\n<Zero Load>\n"
    result = load(tmp_path, INFO + blocks + SINUSOID)
    assert [recording.name for recording in result.recordings] == [
        "run-Find-Contact", "run-Move-Relative", "run-Normal-Indentation", "run-Scripts",
        "run-0.5Hz"]  # fmt: skip
    assert (
        "left out: <Wait> in row 40 (no samples), <Zero Load> in row 42 (no samples)"
        in result.guess
    )


def test_dividers_cut_a_block_into_steps(tmp_path: Path) -> None:
    rows = TABLE[TABLE.index("0.00\t") : TABLE.index("<END DATA>")]
    block = "<Stress Relaxation>\n" + TABLE.replace("<END", f"<divider>\n{rows}<divider>\n<END")
    result = load(tmp_path, INFO + block)
    names = [recording.name for recording in result.recordings]
    assert names == ["run-Stress-Relaxation-1", "run-Stress-Relaxation-2"]
    damaged = block[: block.rindex("1.5")] + block[block.rindex("1.5") :].replace("1.5", "x")
    with pytest.raises(DataError, match="row 16: 'x' is not a number"):
        load(tmp_path, INFO + damaged)


def test_blocks_are_left_out_by_kind_or_for_want_of_samples(tmp_path: Path) -> None:
    other = "<Find Contact>\nStage Axis:\tPosition (z)\n<DATA>\nTime, s\n0\n<divider>\n<END DATA>\n"
    result = load(tmp_path, INFO + other + SINUSOID)
    assert len(result.recordings) == 1
    assert "left out: <Find Contact> in row 8 (2 rows of samples)" in result.guess
    with pytest.raises(DataError, match=r"run\.txt: no block with samples.*<Find Contact>"):
        load(tmp_path, INFO + other)
    uneven = (
        SINUSOID.replace("Sinusoid", "Wait")
        .replace("0.02\t", "0.021\t")
        .replace("0.01\t", "0.009\t")
    )
    with pytest.raises(DataError, match="or leave such blocks out, --block KIND"):
        load(tmp_path, INFO + uneven + SINUSOID)
    file = tmp_path / "run.txt"
    result = import_file(file, None, "none", None, ImportOptions(block="sinusoid"))
    assert len(result.recordings) == 1
    assert "<Wait> in row 8 (--block)" in result.guess


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("\n<END DATA>\n", "", "ends without <END DATA>, within a row"),
        ("300.0\n<END DATA>\n", "3", "ends without <END DATA>, within a row"),
        ("2.0\t300.0\n<END DATA>\n", "2\n", "ends without <END DATA>, within a row"),
        ("Fz, gf", "Fz, stone", "'stone' is not a unit of force"),
        ("Fz, gf", "Fx, gf", "needs one column 'Fz' of force"),
        ("Frequency, Hz:\t0.50000\n", "", "no 'Frequency, Hz'"),
        ("0.50000", "half", "'Frequency, Hz' is 'half', not a number"),
    ],
)
def test_refused(tmp_path: Path, old: str, new: str, message: str) -> None:
    with refusing(DataError, "run.txt", message):
        load(tmp_path, INFO + SINUSOID.replace(old, new))


def test_a_move_that_was_stopped_by_hand_has_whole_rows(tmp_path: Path) -> None:
    whole = load(tmp_path, INFO + SINUSOID)
    stopped = load(tmp_path, INFO + SINUSOID.replace("<END DATA>\n", ""))
    assert "stopped: no <END DATA>, its rows are whole" in stopped.guess
    (left,), (right,) = whole.recordings, stopped.recordings
    assert left.content_hash == right.content_hash
    assert "no <END DATA>" not in whole.guess


def test_a_map_names_the_files_own_labels(tmp_path: Path) -> None:
    file = tmp_path / "run.txt"
    file.write_text(INFO + SINUSOID)
    with pytest.raises(UsageError, match="leave time= out of --map"):
        import_file(file, parse_map("time=10Hz"), "none", None)
    with pytest.raises(DataError, match="needs one column 'Fx' of force"):
        import_file(file, parse_map("force=Fx:N"), "none", None)
    (turned,) = import_file(file, parse_map("force=Fz:-1gf"), "none", None).recordings
    np.testing.assert_allclose(turned.force_n, [-0.980665, -1.96133, -2.941995], rtol=1e-15)


def test_all_blocks_of_a_real_file(mach1_file: Path) -> None:
    result = import_file(mach1_file, None, "first", None)
    names = [recording.name for recording in result.recordings]
    assert names == [f"Dynamic_data-{rate}Hz" for rate in ("0.1", "0.2", "0.5", "1", "2")]
    assert [len(r.position_m) for r in result.recordings] == [20270, 10180, 4130, 2100, 1110]
    for recording in result.recordings:
        assert recording.rate_hz == pytest.approx(100.0)
        assert recording.position_m.max() == pytest.approx(0.0469e-3, rel=0.02)
        assert recording.details["zero_force_n"] == pytest.approx(195.7, rel=0.02)
        # Signs: pressing deeper pushes back harder.
        assert np.corrcoef(recording.position_m, recording.force_n)[0, 1] > 0.9
        assert recording.details["load_cell_low_pass_hz"] == 20.0
