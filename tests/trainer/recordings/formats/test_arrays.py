"""MAT and HDF5 files, units converted once; several files of one object, from either side."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from scipy.io import savemat
from support.files.columns import write_columns
from support.in_process import spring

import springpot
from springpot.codegen.errors import DataError, UsageError
from springpot.trainer.recordings.conditioning import Conditioning
from springpot.trainer.recordings.formats.column_map import parse_map
from springpot.trainer.recordings.formats.importing import ImportOptions, import_file
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


@pytest.mark.parametrize("name", ["fs", "rate", "dt_s", "Sample_Rate"])
@pytest.mark.parametrize("place", ["file", "group", "number"])
def test_a_rate_that_a_file_says_beside_its_channels(tmp_path: Path, name: str, place: str) -> None:
    value = 0.01 if name == "dt_s" else 100.0
    with h5py.File(tmp_path / "a.h5", "w") as opened:
        group = opened.create_group("run")
        group["position_mm"], group["force_N"] = POSITION_MM, FORCE_N
        if place == "number":
            group[name] = value
        else:
            (opened if place == "file" else group).attrs[name] = value
    assert_samples(load(tmp_path / "a.h5"))
    with h5py.File(tmp_path / "a.h5", "a") as opened:
        opened["run"].attrs["rate_hz"] = 50.0  # another one: nobody knows which
    with pytest.raises(DataError, match="time has no array"):
        load(tmp_path / "a.h5")


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


AUTO = ImportOptions(conditioning=Conditioning(contact_force="auto"))


def write_press(
    file: Path, seed: int, depth_m: float, noise_n: float = 0.02, drift_npmin: float = 0.0
) -> None:
    """A press from 2 mm above a soft spring, by a machine that counts from 5 mm, at 200 Hz."""
    rng, time_s = np.random.default_rng(seed), np.arange(0.0, 6.0, 0.005)
    deep_m = -2e-3 + (depth_m + 2e-3) * 0.5 * (1.0 - np.cos(2.0 * np.pi * time_s / 3.0))
    force_n = 400.0 * np.maximum(deep_m, 0.0) ** 1.3 / 0.01**0.3
    force_n += rng.normal(0.0, noise_n, len(time_s)) + drift_npmin * time_s / 60.0
    columns = np.stack([time_s, 1e3 * (deep_m + 5e-3), force_n], axis=1)
    header = "time_s,position_mm,force_N"
    np.savetxt(file, columns, "%.6f", ",", header=header, comments="")


@pytest.mark.filterwarnings("always::UserWarning")
def test_a_set_is_imported_alike_from_python_and_the_command_line(tmp_path: Path) -> None:
    """Each file by itself found a surface of its own: three times the error."""
    folder = tmp_path / "files"
    folder.mkdir()
    for seed, depth_m in enumerate((2e-3, 5e-3, 8e-3)):
        write_press(folder / f"{seed}.csv", seed, depth_m)
    (folder / "notes.md").write_text("left out")
    spring("import", str(folder), "--contact-force", "auto", "--out", str(tmp_path / "out"))
    by_command = springpot.read_recordings(tmp_path / "out")
    for given in (folder, [folder / f"{k}.csv" for k in range(3)]):
        by_python = springpot.import_recordings(given, options=AUTO)
        for one, other in zip(by_command, by_python, strict=True):
            assert one.position_m.tobytes() == other.position_m.tobytes()
            assert one.force_n.tobytes() == other.force_n.tobytes()
    surfaces = {recording.details["contact_position_m"] for recording in by_command}
    assert len(surfaces) == 1
    (recording, *_), surface_m = by_command, surfaces.pop()
    assert abs(surface_m - 5e-3) < recording.details["contact_uncertainty_m"] < 1e-3


@pytest.mark.filterwarnings("always::UserWarning")
def test_presses_of_one_session_from_python(tmp_path: Path) -> None:
    files = [tmp_path / "a.csv", tmp_path / "b.csv"]
    for seed, file in enumerate(files):
        write_press(file, seed, 5e-3)
    first, second = springpot.import_recordings(files, options=AUTO, rest_s=2.0)
    assert second.start_s == pytest.approx(first.duration_s + 2.0)
    assert first.session == second.session != ""


@pytest.mark.filterwarnings("always::UserWarning")
@pytest.mark.parametrize("noise_n", [0.1, 0.3, 0.6])
def test_a_surface_that_is_not_known_is_refused(tmp_path: Path, noise_n: float) -> None:
    """Noise of 0.3 N on a press of 3 N once put the surface 4 mm too deep, "+- 0.03 mm"."""
    file = tmp_path / "noisy.csv"
    write_press(file, 0, 8e-3, noise_n)
    with pytest.raises(DataError, match=r"surface is known to .*: leave --contact-force out"):
        springpot.import_recordings(file, options=AUTO)


def test_a_surface_that_is_hardly_known_is_warned_of(tmp_path: Path) -> None:
    file = tmp_path / "noisy.csv"
    write_press(file, 0, 8e-3, 0.05)
    with pytest.warns(UserWarning, match=r"surface is known to \+- .* mm of .* mm pressed"):
        springpot.import_recordings(file, options=AUTO)


@pytest.mark.filterwarnings("always::UserWarning")
def test_a_minus_of_typesetters_is_one(tmp_path: Path) -> None:
    write_press(tmp_path / "a.csv", 0, 5e-3)
    text = (tmp_path / "a.csv").read_text()
    (tmp_path / "b.csv").write_text(text.replace("-", "\u2212"), encoding="utf-8")
    one, other = (springpot.import_recordings(tmp_path / f"{name}.csv")[0] for name in "ab")
    assert one.force_n.min() < 0.0 and one.force_n.tobytes() == other.force_n.tobytes()


def test_a_file_that_claims_more_than_it_stores_is_refused(tmp_path: Path) -> None:
    """Chunks that were never written take no room, and read as gigabytes."""
    path = tmp_path / "claims.h5"
    with h5py.File(path, "w") as file:
        for name in ("time_s", "position_m", "force_n"):
            file.create_dataset(name, shape=(1 << 28,), dtype="f8", chunks=(1 << 16,))
    assert path.stat().st_size < 100_000
    with pytest.raises(DataError, match=r"claims 6144 MiB of values in \d+ KiB"):
        import_file(path)


def test_values_in_another_file_are_not_read(tmp_path: Path) -> None:
    path = tmp_path / "elsewhere.h5"
    with h5py.File(path, "w") as file:
        file["time_s"], file["force_n"] = np.arange(64.0), np.arange(64.0)
        other = [("/etc/passwd", 0, 64 * 8)]
        file.create_dataset("position_m", shape=(64,), dtype="f8", external=other)
    with pytest.raises(DataError, match="position_m is stored in another file"):
        import_file(path)


def test_a_lazy_table_is_refused_with_what_computes_it() -> None:
    class LazyFrame(dict[str, object]):
        def collect(self) -> None: ...

    with pytest.raises(UsageError, match=r"LazyFrame: not computed yet: give its \.collect\(\)"):
        Recording.from_frame(LazyFrame(), time="t", position="x", force="f")
