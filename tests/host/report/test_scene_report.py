"""The page on a validated scene: its numbers, what it is made of, how it looks on any width."""

import json
import re
from pathlib import Path

import pytest
from support.small import model_file, press, recording, scene

from springpot.codegen.errors import DataError
from springpot.host.emission.emission import emit
from springpot.host.pages.reports import write_report
from springpot.host.validation.store import store_validation
from springpot.host.validation.validation import Validation, validate

FOREIGN = r'(?:src|href)="(?!#)|url\((?!#)|@import|<script'


@pytest.fixture(scope="module")
def emitted(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("emitted")
    emit(scene(), model_file(folder), folder / "c")
    return folder / "c"


@pytest.fixture(scope="module")
def validation(emitted: Path) -> Validation:
    """Of presses at three depths: the errors are not in the order of the recordings."""
    recordings = [recording(f"press-{depth}", press(1.0, depth)) for depth in (0.004, 0.01, 0.007)]
    return validate(emitted, recordings, paced_s=0.1)


@pytest.fixture(scope="module")
def page(emitted: Path, validation: Validation) -> str:
    store_validation(emitted, validation)
    return write_report(emitted).read_text()


def test_the_page_has_the_numbers_of_the_validation(
    emitted: Path, validation: Validation, page: str
) -> None:
    words = re.sub(r"<[^>]*>|[()]|\s+", " ", page)
    found, manifest = validation.accuracy, json.loads((emitted / "manifest.json").read_text())
    for number in (found.rmse_n, found.max_abs_error_n, found.p99_abs_error_n, *found.interval_n):
        assert f" {number:.4g} " in words
    assert "0 ticks differ" in words and f"{manifest['state_bytes']} bytes of state" in words
    assert re.search(r"flash\s+\d+ bytes  host ", words)
    for item in manifest["left_out"]:
        assert item["what"] in words
    assert manifest["hash"] in words


def test_the_page_needs_no_other_file(page: str) -> None:
    assert len(re.findall("<svg", page)) == 3
    assert not re.search(FOREIGN, page.replace('href="data:', 'href="#').replace("xlink:", ""))


def test_an_emission_that_was_not_validated_is_one_line(tmp_path: Path) -> None:
    emit(scene(), model_file(tmp_path), tmp_path / "c")
    with pytest.raises(DataError, match="no validation to report: run `springpot validate"):
        write_report(tmp_path / "c")
