"""`springpot completion`: what shells need to complete its commands."""

from springpot.console import LazyCommand

COMPLETION = LazyCommand("springpot.host.wings.completion.command:completion", place=22)
