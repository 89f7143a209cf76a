"""The reference in the pages themselves: plain Markdown for those who read a clone.

    PYTHONPATH=docs/_ext:build/ns python -m reference_pages

It stands between `<!-- generated: NAME -->` and `<!-- end -->`, and a test compares it with the
code. The site has directives in its place (reference_pages/__init__.py), to which pages can link.
"""

import inspect
import re
from collections.abc import Callable, Iterator
from pathlib import Path

import click

import springpot
from reference_pages.c_header import declarations, notes
from reference_pages.commands import every_command, option_facts, option_names
from reference_pages.exit_statuses import exit_status_table
from reference_pages.scene_keys import scene_key_tables
from reference_pages.wire import wire_messages
from springpot.host.cli import springpot as cli

_TARGET = re.compile(r"\[(`\w+`)\]\{#[\w-]+\}")  # for links on the site
PAGES = Path(__file__).parents[2]
MARK = re.compile(r"^<!-- generated: ([a-z ]+) -->\n.*?^<!-- end -->$", re.M | re.S)


def command_list() -> str:
    """Markdown: a paragraph for every command, and a line for each of its options."""
    return "\n".join(
        line
        for name, command in every_command(click.Context(cli, info_name="springpot"))
        for line in _command_lines(name, command)
    )


def _command_lines(name: str, command: click.Command) -> Iterator[str]:
    context = click.Context(command, info_name=name)
    usage = command.get_usage(context).removeprefix("Usage: ")
    first = inspect.cleandoc(command.help or "").split("\n\n")[0]
    yield from ("", f"`{' '.join(usage.split())}`: {' '.join(first.split())}", "")
    for option in command.params:
        if isinstance(option, click.Option):
            facts = option_facts(option, context)
            yield f"- `{option_names(option, context)}`" + f": {facts}" * bool(facts)


def c_function_list() -> str:
    """Markdown: every function of sp.h and what it does."""
    return "\n".join(
        f"- {', '.join(f'`{name}`' for name in group.functions)}: {group.comment}"
        for group in declarations()
    )


def c_note_table() -> str:
    """Markdown: a table of what a call returns."""
    rows = [f"| {value} | `{name}` | {meaning} |" for name, value, meaning in notes()]
    return "\n".join(["| return | name | meaning |", "| --- | --- | --- |", *rows])


def python_list() -> str:
    """Markdown: every public name, with the parameters of functions."""
    return "\n".join(_python_line(name) for name in dir(springpot))


def _python_line(name: str) -> str:
    item = getattr(springpot, name)
    first = (inspect.getdoc(item) or "").split("\n\n")[0]
    parameters = ""
    if inspect.isfunction(item):
        parameters = f"({', '.join(inspect.signature(item).parameters)})"
    return f"- `{name}{parameters}`: {' '.join(first.split())}"


PLAIN: dict[str, Callable[[], str]] = {
    "commands": command_list,
    "exit statuses": exit_status_table,
    "scene keys": lambda: _TARGET.sub(r"\1", scene_key_tables()),
    "c functions": c_function_list,
    "c notes": c_note_table,
    "python names": python_list,
    "wire": wire_messages,
}


def written(page: str) -> str:
    """Return a page with what its marks stand for between them."""
    return MARK.sub(
        lambda mark: f"<!-- generated: {mark[1]} -->\n{PLAIN[mark[1]]()}\n<!-- end -->", page
    )


def write_pages() -> None:
    """Write every page whose lists differ from the code."""
    for path in PAGES.rglob("*.md"):
        page = path.read_text(encoding="utf-8")
        if written(page) != page:
            path.write_text(written(page), encoding="utf-8")
