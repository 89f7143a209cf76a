"""Every command with its arguments and options, as click itself knows them."""

from collections.abc import Iterator
from inspect import cleandoc

import click

from springpot.host.cli import springpot


def command_pages() -> str:
    """Markdown: a section a command, a target for each option."""
    context = click.Context(springpot, info_name="springpot")
    return "\n".join(line for name, command in every_command(context)
                     for line in _section(name, command))  # fmt: skip


def every_command(context: click.Context) -> Iterator[tuple[str, click.Command]]:
    """Full name and command, those of groups too; not the groups themselves."""
    group = context.command
    assert isinstance(group, click.Group)
    for name in group.list_commands(context):
        command = group.get_command(context, name)
        assert command is not None
        if isinstance(command, click.Group):
            yield from every_command(click.Context(command, info_name=name, parent=context))
        else:
            yield f"{context.command_path} {name}", command


def _section(name: str, command: click.Command) -> Iterator[str]:
    context = click.Context(command, info_name=name)
    yield from ("", f"## {name}", "", f"```{{program}} {name}", "```", "", "```text")
    yield command.get_usage(context).removeprefix("Usage: ")
    yield from ("```", "", *_paragraphs(cleandoc(command.help or "")))
    for parameter in command.params:
        if isinstance(parameter, click.Option):
            yield from ("", f":::{{option}} {option_names(parameter, context)}")
            yield from (option_facts(parameter, context), ":::")
    yield from _paragraphs(command.epilog or "")


def _paragraphs(text: str) -> Iterator[str]:
    r"""Lines of a help text; those of a paragraph marked \b, which click does not wrap, end so.

    What is set in below its first line is code.
    """
    for paragraph in text.replace("\f", "").split("\n\n"):
        lines = paragraph.splitlines()
        if lines and lines[0] == "\b":
            inner = [line for line in lines[1:] if line.startswith("  ")]
            outer = [line for line in lines[1:] if line not in inner]
            yield from ("", *(f"{line}\\" for line in outer[:-1]), *outer[-1:])
            yield from ("", "```sh", *(line.strip() for line in inner), "```") if inner else ()
        else:
            yield from ("", *lines)


def option_names(option: click.Option, context: click.Context) -> str:
    """Return the names of an option and what follows them."""
    value = "" if option.is_flag or option.count else f" {option.make_metavar(context)}"
    names = [*option.opts, *option.secondary_opts]
    return ", ".join(f"{name}{value}" for name in names)


def option_facts(option: click.Option, context: click.Context) -> str:
    """Its help, then what click puts into brackets: whether it is required, its range, default."""
    extra = option.get_help_extra(context)
    facts = ["Required."] if "required" in extra else []
    facts += [f"Range: {extra['range']}."] if "range" in extra else []
    facts += [f"Default: `{extra['default']}`."] if "default" in extra else []
    return " ".join([*filter(None, [option.help]), *facts])
