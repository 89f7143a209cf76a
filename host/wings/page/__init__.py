"""A page in which people press emitted scenes, in a browser."""

from springpot.console import LazyCommand

PAGE = LazyCommand("springpot.host.wings.page.command:page", place=18)
