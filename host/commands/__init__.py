"""The command line: one file a command. This table is registered in pyproject.toml."""

from springpot.host.console.lazy_group import LazyCommand

_HERE = "springpot.host.commands"
DOCTOR = LazyCommand(
    f"{_HERE}.doctor:doctor",
    "Show what this machine offers, and what to do where something is missing.",
    0,
)
DEMO = LazyCommand(
    f"{_HERE}.scenes.demo:demo",
    "Do the whole job on a simulated object: record, train, emit, build, validate, report.",
    1,
)
RECORD = LazyCommand(
    f"{_HERE}.recordings.record:record",
    "Drive a device under force control and write one recording for each profile.",
    2,
)
IMPORT = LazyCommand(
    f"{_HERE}.recordings.import_:import_",
    "Turn CSV, MAT, HDF5, Mach-1 text files, CAN logs and journals into recordings.",
    3,
)
CHECK = LazyCommand(
    f"{_HERE}.recordings.check:check_",
    "Report the quality of RECORDINGS (files or folders); refusals end with status 3.",
    4,
)
PLOT = LazyCommand(
    f"{_HERE}.recordings.plot:plot",
    "Draw RECORDINGS: time series, loops by rate and amplitude, spectra, stiffness and loss.",
    5,
)
EXPORT = LazyCommand(
    f"{_HERE}.recordings.export:export_",
    "Write RECORDINGS (files or folders) as files that other programs read.",
    6,
)
TRAIN = LazyCommand(
    f"{_HERE}.models.train:train",
    "Fit a model on RECORDINGS (files or folders).",
    7,
)
EMIT = LazyCommand(
    f"{_HERE}.scenes.emit:emit_",
    "Emit the C source of a scene, or of a benchmark's pick (keys of --scene override it).",
    8,
)
BUILD = LazyCommand(
    f"{_HERE}.scenes.emit:build",
    "Build an emitted FOLDER's shared library in the cache; print its path.",
    9,
)
FIRMWARE = LazyCommand(
    f"{_HERE}.scenes.firmware:firmware",
    "Build a board's firmware; all its sources lie beside it.",
    10,
)
STABILITY = LazyCommand(
    f"{_HERE}.scenes.stability:stability_",
    "Spectral radius, small-signal maps, and a closed loop with three hands.",
    11,
)
VALIDATE = LazyCommand(
    f"{_HERE}.scenes.validate:validate_",
    "Replay recordings through the C of an emitted FOLDER.",
    12,
)
RUN = LazyCommand(
    f"{_HERE}.scenes.run:run",
    "Render a scene on a device.",
    13,
)
REPORT = LazyCommand(
    f"{_HERE}.scenes.report:report",
    "Write a self-contained HTML page on FOLDER: a benchmark, or an emitted, validated scene.",
    17,
)
COMPLETION = LazyCommand(
    f"{_HERE}.completion:completion",
    "Print the script with which a SHELL completes commands, options and file names.",
    22,
)
