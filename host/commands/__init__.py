"""The command line: one file a command; this table is in the order of a job."""

_HERE = "springpot.host.commands"
COMMANDS = {
    "doctor": f"{_HERE}.doctor:doctor",
    "demo": f"{_HERE}.demo:demo",
    "record": f"{_HERE}.record:record",
    "import": f"{_HERE}.import_:import_",
    "check": f"{_HERE}.check:check_",
    "train": f"{_HERE}.train:train",
    "emit": f"{_HERE}.emit:emit_",
    "build": f"{_HERE}.emit:build",
    "firmware": f"{_HERE}.emit:firmware",
    "stability": f"{_HERE}.stability:stability_",
    "validate": f"{_HERE}.validate:validate_",
    "run": f"{_HERE}.run:run",
    "bench": f"{_HERE}.bench:bench",
    "report": f"{_HERE}.demo:report",
    "page": f"{_HERE}.page:page",
    "study": f"{_HERE}.study:study",
}
