"""The smallest scene's emission is checked in: a change of output shows in the diff."""

from support.smallest_scene import FOLDER, smallest_emission


def test_emission_is_what_is_checked_in() -> None:
    emitted = smallest_emission()
    assert sorted(emitted) == sorted(path.name for path in FOLDER.iterdir())
    for name, text in emitted.items():
        assert (FOLDER / name).read_text() == text, f"{name}: run support/smallest_scene.py"
