"""MAT and HDF5 files: the same samples, units converted once."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from scipy.io import savemat
from support.files.columns import write_columns

from springpot.codegen.errors import DataError
from springpot.trainer.recordings.formats.column_map import parse_map
from springpot.trainer.recordings.formats.importing import import_file
from springpot.trainer.recordings.recording import Recording

TIME_S = np.arange(50) * 0.01
POSITION_MM = 5 * np.sin(TIME_S) ** 2
FORCE_N = 3 * POSITION_MM


def load(path: Path, mapping: str = "") -> Recording:
    return import_file(path, parse_map(mapping) if mapping else None)[0]


def assert_samples(recording: Recording, tolerance: float = 1e-15) -> None:
    np.testing.assert_allclose(recording.position_m, POSITION_MM * 1e-3, rtol=0, atol=tolerance)
    np.testing.assert_allclose(recording.force_n, FORCE_N, rtol=0, atol=1e3 * tolerance)
    assert recording.dt_s == pytest.approx(0.01)


def test_mat_5(tmp_path: Path) -> None:
    file = tmp_path / "a.mat"
    savemat(file, {"time_s": TIME_S, "position_mm": POSITION_MM, "force_N": FORCE_N, "who": "me"})
    recording = load(file)
    assert_samples(recording)
    assert recording.details["units"]["position"] == {
        "unit": "mm", "to_si": 1e-3, "from": "name", "column": "position_mm"
    }  # fmt: skip
    rig = {"t": TIME_S, "Load": FORCE_N / 1e3, "nested": {"Extension": POSITION_MM}}
    savemat(file, {"rig": rig})
    assert_samples(load(file, "time=rig.t:s,position=rig.nested.Extension:mm,force=rig.Load:kN"))
    with pytest.raises(DataError, match=r"a\.mat, array 'rig.Load': no unit of force"):
        load(file, "time=rig.t:s,position=rig.nested.Extension:mm")
    savemat(file, {"data": np.stack((POSITION_MM, FORCE_N), axis=1)})
    assert_samples(load(file, "time=100Hz,position=data[1]:mm,force=data[2]:N"))
    with pytest.raises(DataError, match=r"time has no array; it holds 'data\[1\]', 'data\[2\]'"):
        load(file)


def mat_73(file: Path) -> None:
    """As MATLAB writes it: HDF5 behind a block of 512 bytes, vectors as matrices of one column."""
    with h5py.File(file, "w", userblock_size=512) as opened:
        for name, values in (
            ("time_s", TIME_S),
            ("position_mm", POSITION_MM),
            ("force_N", FORCE_N),
        ):
            opened.create_dataset(f"rig/{name}", data=values[None, :]).attrs["MATLAB_class"] = (
                b"double"
            )
    with file.open("r+b") as opened:
        opened.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(512))


def test_mat_73(tmp_path: Path) -> None:
    mat_73(tmp_path / "a.mat")
    assert_samples(load(tmp_path / "a.mat"))


def test_hdf5_of_another_layout(tmp_path: Path) -> None:
    file = tmp_path / "a.h5"
    with h5py.File(file, "w") as opened:
        opened["run/t"] = TIME_S
        opened["run/z"] = POSITION_MM
        opened["run/z"].attrs["units"] = "mm"
        opened["run/F"] = np.stack((FORCE_N, -FORCE_N))
        opened["run/table"] = np.zeros(3, dtype=[("a", "f8")])
    assert_samples(load(file, "time=run/t:s,position=/run/z,force=run/F[1]:N"))
    with pytest.raises(DataError, match=r"force may be 'run/F\[1\]', 'run/F\[2\]'"):
        load(file, "time=run/t:s")
    with pytest.raises(DataError, match=r"no array 'run/x'; it holds 'run/F\[1\]'"):
        load(file, "position=run/x:mm")
    with h5py.File(file, "a") as opened:
        del opened["run/t"]
        opened["run/t"] = TIME_S[:-1]
    with pytest.raises(DataError, match="channels of different lengths"):
        load(file, "time=run/t:s,force=run/F[1]:N")


@pytest.mark.parametrize(
    ("attribute", "value", "refused"),
    [
        ("scale_factor", 0.5, True),
        ("scale_factor", 1.0, False),
        ("add_offset", 2.0, True),
        ("conversion", np.array([1e-3]), True),
        ("_FillValue", 0.0, True),
        ("_FillValue", -999.0, False),
    ],
)
def test_numbers_that_are_not_the_values_are_refused(
    attribute: str, value: float, refused: bool, tmp_path: Path
) -> None:
    """As netCDF-4 and NWB store them."""
    with h5py.File(tmp_path / "a.h5", "w") as opened:
        for name, values in (("time_s", TIME_S), ("z_mm", POSITION_MM), ("force_N", FORCE_N)):
            opened[name] = values
        opened["force_N"].attrs[attribute] = value
        opened["other"] = TIME_S
        opened["other"].attrs["scale_factor"] = 2.0
    if refused:
        with pytest.raises(DataError, match=f"array 'force_N': its {attribute} is not applied"):
            load(tmp_path / "a.h5")
    else:
        assert_samples(load(tmp_path / "a.h5"))


@pytest.mark.parametrize("form", ["csv", "mat"])
def test_samples_come_back_bit_for_bit(tmp_path: Path, form: str) -> None:
    noise = np.random.default_rng(1).normal(size=(2, 999))
    written = Recording("a.b", noise[0] * 1e-3, noise[1], 1e-3, details={"k": 1})
    back = load(write_columns(tmp_path / f"a.b.{form}", written))
    assert back.position_m.tobytes() == written.position_m.tobytes()
    assert back.force_n.tobytes() == written.force_n.tobytes()
    assert back.dt_s == pytest.approx(1e-3, rel=1e-12)
