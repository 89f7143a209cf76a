"""The command line: one file a command; this table is in the order of a job."""

_HERE = "springpot.host"
COMMANDS = {
    "doctor": f"{_HERE}.commands.doctor:doctor",
    "demo": f"{_HERE}.report.commands:demo",
    "record": f"{_HERE}.commands.record:record",
    "import": f"{_HERE}.commands.import_:import_",
    "check": f"{_HERE}.commands.check:check_",
    "train": f"{_HERE}.commands.train:train",
    "emit": f"{_HERE}.commands.emit:emit_",
    "build": f"{_HERE}.commands.emit:build",
    "firmware": f"{_HERE}.boards.command:firmware",
    "stability": f"{_HERE}.commands.stability:stability_",
    "validate": f"{_HERE}.commands.validate:validate_",
    "run": f"{_HERE}.commands.run:run",
    "bench": f"{_HERE}.bench.command:bench",
    "report": f"{_HERE}.report.commands:report",
    "page": f"{_HERE}.page.command:page",
    "study": f"{_HERE}.study.commands:study",
}
