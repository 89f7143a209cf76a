"""`springpot study plan`: freeze a study file, and say what it takes."""

from pathlib import Path
from typing import Any

import click

from springpot.console import json_option, print_result, progress_bar


@click.command()
@click.argument("file", type=click.Path(path_type=Path))
@click.option(
    "--participants",
    type=click.IntRange(1, 999),
    required=True,
    help="How many people; codes and orders are made for each.",
)
@click.option("--out", type=click.Path(path_type=Path), required=True, help="A new folder.")
@json_option
def plan(file: Path, participants: int, out: Path, as_json: bool) -> None:
    """Freeze a study FILE into a folder: scenes, orders, codes.

    Prints what to have at hand, how long it takes, and what so many people can find. The key that
    opens the codes is key.json in the folder: who runs the study does not look at it.
    """
    from springpot.host.wings.study.folder import write_study
    from springpot.host.wings.study.outline import outline

    with progress_bar("emitting scenes") as progress:
        task = progress.task_ids[0]
        folder = write_study(
            file,
            participants,
            out,
            lambda done, of: progress.update(task, completed=done, total=of),
        )
    found = outline(folder)
    print_result(found, as_json, _rows(found))


def _rows(found: dict[str, Any]) -> dict[str, str]:
    sessions, trials = found["sessions"], found["trials"]
    length = "as many trials as answers need" if trials is None else f"{trials} trials"
    power = found["power"]
    return {
        "study": found["out"],
        "people": f"{found['participants']}, {sessions} session{'s' * (sessions > 1)} of {length}"
        + (f", {found['practice']} for practice before" if found["practice"] else ""),
        "minutes": "not known before" if found["minutes"] is None
        else f"about {found['minutes']:.0f} a session",
        "order": found["order"],
        "conditions": f"{found['conditions']}, {found['blind']} of them could be double-blind "
        "(scene against scene)",
        "at hand": "\n".join(f"{sticker}: {real}" for sticker, real in found["stickers"].items())
        or "no real objects",
        **({"power": power["line"]} if power else {}),
        "key": f"{found['key']} opens the codes: not for who runs the study",
    }  # fmt: skip
