"""The command that writes a page to press."""

from springpot.console import LazyCommand

_HERE = "springpot.host.wings.page.commands"
PAGE = LazyCommand(
    f"{_HERE}.page:page",
    "Write one HTML file in which people press the emitted FOLDERS, in a browser.",
    18,
)
