import io
from pathlib import Path

import numpy as np
import pytest
from support.small import model_file, small_model, training

from springpot.codegen.errors import DataError
from springpot.codegen.model.model_file import MODEL_SUFFIX, model_hash, read_model, write_model
from springpot.trainer.kinds import fit_model
from springpot.trainer.models.fit import FitOptions


def test_round_trip_keeps_everything(tmp_path: Path) -> None:
    path = model_file(tmp_path)
    read = read_model(path)
    assert model_hash(read) == model_hash(small_model())
    assert read.trained == small_model().trained
    assert read.provenance == small_model().provenance
    np.testing.assert_array_equal(read.regressor.threshold, small_model().regressor.threshold)


def test_any_flipped_byte_is_refused(tmp_path: Path) -> None:
    path = model_file(tmp_path)
    content = path.read_bytes()
    damaged = tmp_path / "damaged.spm"
    places = [*range(120), *np.linspace(120, len(content) - 1, 150).astype(int)]
    for place in places:
        damaged.write_bytes(content[:place] + bytes([content[place] ^ 0x10]) + content[place + 1 :])
        with pytest.raises(DataError) as refusal:
            read_model(damaged)
        assert "\n" not in str(refusal.value)
        assert "damaged.spm" in str(refusal.value)


@pytest.mark.parametrize("length", [0, 5, 40, 90, 5000, -1])
def test_a_truncated_file_is_refused(tmp_path: Path, length: int) -> None:
    path = model_file(tmp_path)
    path.write_bytes(path.read_bytes()[:length])
    with pytest.raises(DataError, match=r"model\.spm: (damaged|not a springpot model)"):
        read_model(path)


def test_a_later_schema_is_refused(tmp_path: Path) -> None:
    path = model_file(tmp_path)
    path.write_bytes(path.read_bytes().replace(b"springpot-model 4", b"springpot-model 7", 1))
    with pytest.raises(DataError, match="schema 7, this springpot reads up to 4: upgrade"):
        read_model(path)


def test_a_file_of_the_schema_before_is_read_and_keeps_its_hash(tmp_path: Path) -> None:
    path = model_file(tmp_path)
    content = path.read_bytes()
    header = np.load(io.BytesIO(content.split(b"\n", 1)[1]))["header"].tobytes()
    assert b"elastic_n" in header
    assert b"stretch" not in header  # what stands at its default is not written
    path.write_bytes(content.replace(b"springpot-model 4", b"springpot-model 3", 1))
    assert model_hash(read_model(path)) == model_hash(small_model())


def test_the_suffix_is_what_other_programs_look_for() -> None:
    assert MODEL_SUFFIX == ".spm"


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(DataError, match=r"none\.spm: cannot be read \(No such file"):
        read_model(tmp_path / "none.spm")


def test_same_seed_and_recordings_give_the_same_hash(tmp_path: Path) -> None:
    options = FitOptions(seed=3, trees=3, leaf=30)
    first = fit_model("rf-fd", "a", training(), options).model
    again = fit_model("rf-fd", "a", training(), options).model
    other = fit_model("rf-fd", "a", training(), FitOptions(seed=4, trees=3, leaf=30)).model
    assert model_hash(first) == model_hash(again) != model_hash(other)
    assert write_model(tmp_path / "a.spm", first) == model_hash(first)
    assert (tmp_path / "a.spm").read_bytes()[:17] == b"springpot-model 4"
