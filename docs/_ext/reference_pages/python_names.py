"""Every public name of `import springpot` and of its public modules, for autodoc."""

import inspect
from importlib import import_module
from pathlib import Path

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
# What a package fills in or inherits from, whole (docs/how-to/extend.md); of others the first line.
_EXTENDED = {
    "console": ("LazyCommand",),
    "devices": ("Driver", "Address", "DeviceRequirements", "OpenedDevice"),
    "emission": ("FeatureStage", "RegressorStage", "Member"),
    "modelling": (
        "Kind", "Features", "Regressor", "TrainingSet", "FileFormat", "FileRequest", "RawChannels",
    ),
    "native": ("CLibrary",),
}  # fmt: skip
_DIRECTIVES = {"function": "autofunction", "class": "autoclass", "error": "autoexception"}


def python_name_list() -> str:
    """Markdown: a section of functions, of classes and of errors."""
    lines = ["```{eval-rst}", ".. currentmodule:: springpot", "```"]
    for kind, title in _TITLES.items():
        lines += ["", title, "", "```{eval-rst}"]
        for name in vars(springpot)["__all__"]:
            if _kind(getattr(springpot, name)) != kind:
                continue
            lines += [f".. {_DIRECTIVES[kind]}:: {name}"]
            lines += [*(f"   :{option}" for option in _OPTIONS[kind]), ""]
        lines.append("```")
    return "\n".join(lines)


def public_modules() -> list[str]:
    """Public modules of springpot: those that say what they offer and are not springpot's home."""
    homes = ("__init__", "files", "lazy_names", "loaded", "steps")
    files = Path(springpot.__file__).parent.glob("*.py")
    return sorted(file.stem for file in files if file.stem not in homes)


def public_module_list() -> str:
    """Markdown: a section a public module, with its example and a line for each name."""
    lines: list[str] = []
    for name in public_modules():
        module = import_module(f"springpot.{name}")
        title, _, example = inspect.cleandoc(module.__doc__ or "").partition("\n")
        lines += ["", f"## springpot.{name}", "", title, "", "```pycon", example.strip(), "```", ""]
        lines += [
            f"- `{public}`{_first_line(getattr(module, public))}"
            for public in vars(module)["__all__"]
            if public not in _EXTENDED.get(name, ())
        ]
        lines += ["", "```{eval-rst}", f".. currentmodule:: springpot.{name}", ""]
        for public in _EXTENDED.get(name, ()):
            lines += [f".. autoclass:: {public}", "   :members:", "   :inherited-members:", ""]
        lines.append("```")
    return "\n".join(lines)


def _first_line(found: object) -> str:
    """The first sentence of what a class or function says; a constant says nothing."""
    said = inspect.getdoc(found) if inspect.isroutine(found) or inspect.isclass(found) else None
    return f": {said.splitlines()[0]}" if said else ""


def _kind(found: object) -> str:
    if not inspect.isclass(found):
        return "function"
    return "error" if issubclass(found, Exception) else "class"
