"""Commands that show results: the page on a scene, pictures of recordings, the demo."""

from springpot.console import LazyCommand

_HERE = "springpot.host.wings.report.commands"
DEMO = LazyCommand(f"{_HERE}.demo:demo", place=1)
REPORT = LazyCommand(f"{_HERE}.report:report", place=17)
