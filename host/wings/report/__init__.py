"""Show results: the page on a scene, and the demo."""

from springpot.console import LazyCommand

DEMO = LazyCommand("springpot.host.wings.report.commands:demo", place=1)
REPORT = LazyCommand("springpot.host.wings.report.commands:report", place=17)
