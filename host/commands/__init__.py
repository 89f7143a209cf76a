"""The command line: one file a command. This table is registered in pyproject.toml."""

from springpot.host.console.lazy_group import LazyCommand

_HERE = "springpot.host.commands"
RECORD = LazyCommand(f"{_HERE}.recordings.record:record", place=2)
IMPORT = LazyCommand(f"{_HERE}.recordings.import_:import_", place=3)
CHECK = LazyCommand(f"{_HERE}.recordings.check:check_", place=4)
TRAIN = LazyCommand(f"{_HERE}.models.train:train", place=7)
EMIT = LazyCommand(f"{_HERE}.scenes.emit:emit_", place=8)
BUILD = LazyCommand(f"{_HERE}.scenes.emit:build", place=9)
STABILITY = LazyCommand(f"{_HERE}.scenes.stability:stability_", place=11)
VALIDATE = LazyCommand(f"{_HERE}.scenes.validate:validate_", place=12)
RUN = LazyCommand(f"{_HERE}.scenes.run:run", place=13)
