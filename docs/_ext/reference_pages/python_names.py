"""Every public name of `import springpot`, for autodoc."""

import inspect

import springpot

_TITLES = {
    "function": "## Functions",
    "class": "## Classes",
    "error": "## Errors",
}
_OPTIONS = {
    "function": (),
    "class": ("members:", "undoc-members:", "member-order: bysource"),
    "error": ("show-inheritance:",),
}
_DIRECTIVES = {"function": "autofunction", "class": "autoclass", "error": "autoexception"}


def python_name_list() -> str:
    """Markdown: a section of functions, of classes and of errors."""
    lines = ["```{eval-rst}", ".. currentmodule:: springpot", "```"]
    for kind, title in _TITLES.items():
        lines += ["", title, "", "```{eval-rst}"]
        for name in dir(springpot):
            if _kind(getattr(springpot, name)) != kind:
                continue
            lines += [f".. {_DIRECTIVES[kind]}:: {name}"]
            lines += [*(f"   :{option}" for option in _OPTIONS[kind]), ""]
        lines.append("```")
    return "\n".join(lines)


def _kind(found: object) -> str:
    if not inspect.isclass(found):
        return "function"
    return "error" if issubclass(found, Exception) else "class"
