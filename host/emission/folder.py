"""An emitted folder, given as such or as a scene file."""

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from springpot.codegen.errors import UsageError
from springpot.host.console.output import say
from springpot.host.emission.emission import SCENE_COPY, emit
from springpot.host.emission.scene_file import model_path, read_scene


@contextmanager
def emitted_folder(scene: Path) -> Iterator[Path]:
    """The folder itself, or that of a scene file emitted for this session."""
    if (scene / SCENE_COPY).exists():
        yield scene
        return
    if scene.is_dir():
        raise UsageError(f"{scene}: not an emitted folder: `springpot emit --out` makes one")
    described = read_scene(scene)
    with tempfile.TemporaryDirectory(prefix="springpot-run-") as scratch:
        folder = Path(scratch) / "c"
        for found in emit(described, model_path(described, scene), folder).notices:
            say(found)
        yield folder
