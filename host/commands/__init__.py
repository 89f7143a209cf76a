"""The command line: one file a command; this table is in the order of a job."""

from springpot.host.console.lazy_group import LazyCommand

_HERE = "springpot.host"
COMMANDS = {
    "doctor": LazyCommand(f"{_HERE}.doctor.doctor:doctor"),
    "demo": LazyCommand(f"{_HERE}.report.commands:demo"),
    "record": LazyCommand(f"{_HERE}.commands.recordings.record:record"),
    "import": LazyCommand(f"{_HERE}.commands.recordings.import_:import_"),
    "check": LazyCommand(f"{_HERE}.commands.recordings.check:check_"),
    "train": LazyCommand(f"{_HERE}.commands.models.train:train"),
    "emit": LazyCommand(f"{_HERE}.commands.scenes.emit:emit_"),
    "build": LazyCommand(f"{_HERE}.commands.scenes.emit:build"),
    "firmware": LazyCommand(f"{_HERE}.boards.command:firmware"),
    "stability": LazyCommand(f"{_HERE}.commands.scenes.stability:stability_"),
    "validate": LazyCommand(f"{_HERE}.commands.scenes.validate:validate_"),
    "run": LazyCommand(f"{_HERE}.commands.scenes.run:run"),
    "bench": LazyCommand(f"{_HERE}.bench.command:bench"),
    "report": LazyCommand(f"{_HERE}.report.commands:report"),
    "page": LazyCommand(f"{_HERE}.page.command:page"),
    "study": LazyCommand(
        f"{_HERE}.study.commands:study",
        "Does it feel like the object? Plan a study, run it with people, and report.",
    ),
}
