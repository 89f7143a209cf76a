"""What the tests of the host's rooms share."""

from pathlib import Path

import pytest
from support.small import model_file, scene

from springpot.host.emission.emission import emit


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Emit the small scene, once for a module."""
    base = tmp_path_factory.mktemp("scene")
    return emit(scene(), model_file(base), base / "c").folder
