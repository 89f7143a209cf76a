"""The C of the stages, as jinja2 templates of codegen/stages/templates."""

from importlib.resources import files


def stage_code(name: str) -> str:
    """Return the text of NAME.c.j2; its blocks are named in `Stage.code`."""
    template = files("springpot.codegen.stages") / "templates" / f"{name}.c.j2"
    return template.read_text(encoding="utf-8")
