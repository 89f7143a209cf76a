"""`springpot completion`: what a shell needs to complete commands and options."""

import click
from click.shell_completion import get_completion_class

_LINES = {
    "bash": "springpot completion bash > ~/.local/share/bash-completion/completions/springpot",
    "zsh": 'springpot completion zsh > "${fpath[1]}/_springpot"',
    "fish": "springpot completion fish > ~/.config/fish/completions/springpot.fish",
}


@click.command(
    epilog="\b\nWhere it goes, once:\n" + "\n".join(f"  {line}" for line in _LINES.values())
)
@click.argument("shell", type=click.Choice(list(_LINES)))
@click.pass_context
def completion(context: click.Context, shell: str) -> None:
    """Print the script with which a SHELL completes commands, options and file names."""
    script = get_completion_class(shell)
    assert script is not None
    click.echo(script(context.find_root().command, {}, "springpot", "_SPRINGPOT_COMPLETE").source())
