"""The command line: one file a command; this table is in the order of a job."""

_HERE = "springpot.host"
COMMANDS = {
    "doctor": f"{_HERE}.doctor.doctor:doctor",
    "demo": f"{_HERE}.report.commands:demo",
    "record": f"{_HERE}.commands.recordings.record:record",
    "import": f"{_HERE}.commands.recordings.import_:import_",
    "check": f"{_HERE}.commands.recordings.check:check_",
    "train": f"{_HERE}.commands.models.train:train",
    "emit": f"{_HERE}.commands.scenes.emit:emit_",
    "build": f"{_HERE}.commands.scenes.emit:build",
    "firmware": f"{_HERE}.boards.command:firmware",
    "stability": f"{_HERE}.commands.scenes.stability:stability_",
    "validate": f"{_HERE}.commands.scenes.validate:validate_",
    "run": f"{_HERE}.commands.scenes.run:run",
    "bench": f"{_HERE}.bench.command:bench",
    "report": f"{_HERE}.report.commands:report",
    "page": f"{_HERE}.page.command:page",
    "study": f"{_HERE}.study.commands:study",
}
