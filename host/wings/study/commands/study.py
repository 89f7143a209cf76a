"""`springpot study` and its parts: plan, run, simulate, report."""

import sys
import time
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import click

from springpot import UsageError
from springpot.console import SEED, LazyGroup, json_option, print_result, progress_bar, say


@click.command("plan")
@click.argument("file", type=click.Path(path_type=Path))
@click.option(
    "--participants",
    type=click.IntRange(1, 999),
    required=True,
    help="How many people; codes and orders are made for each.",
)
@click.option("--out", type=click.Path(path_type=Path), required=True, help="A new folder.")
@json_option
def plan_study(file: Path, participants: int, out: Path, as_json: bool) -> None:
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
    print_result(found, as_json, _plan_rows(found))


def _plan_rows(found: dict[str, Any]) -> dict[str, str]:
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


@click.command("run")
@click.argument("study", type=click.Path(path_type=Path))
@click.option("--participant", required=True, help="Number of the participant, such as 07.")
@click.option(
    "--device", "url", help="Such as serial:///dev/ttyACM0; needed where scenes are felt."
)
@json_option
def run_study(study: Path, participant: str, url: str | None, as_json: bool) -> None:
    """Go on with the next session of one participant of the planned STUDY.

    The participant's screen is a page in a browser, worked by the keyboard alone; this terminal is
    the experimenter's. Stopped by q, Ctrl-C or a crash, the same command goes on where it was.
    """
    from springpot.console import reading_keys, stopping_on_sigterm
    from springpot.host.wings.study.folder import read_folder
    from springpot.host.wings.study.session.apparatus import Apparatus
    from springpot.host.wings.study.session.conduct import (
        SessionStoppedError,
        conduct,
        next_session,
    )
    from springpot.host.wings.study.session.experimenter import KEYS, Experimenter
    from springpot.host.wings.study.session.presenter import DevicePresenter
    from springpot.host.wings.study.session.screen import DEEPEST_M, ParticipantScreen

    folder = read_folder(study)
    session = next_session(folder, participant)
    if session is None:
        raise UsageError(f"{study}: participant {participant} has finished all sessions")
    if folder.scenes and url is None:
        raise UsageError("scenes are felt in this study: give the device, --device URL")
    if url is not None and not folder.scenes:
        raise UsageError("no scene is felt in this study: leave --device out")
    if any(stimulus.real for stimulus in folder.study.stimulus) and not sys.stdin.isatty():
        raise UsageError(
            "real objects are placed by hand, which a key confirms: run it in a terminal"
        )
    stopped = "the session is over"
    counts = {"done": 0, "void": 0}
    with (
        stopping_on_sigterm(),
        ParticipantScreen(folder.deepest_m or DEEPEST_M) as screen,
        reading_keys() as keys,
        nullcontext() if url is None else Apparatus(folder, url, screen, say) as apparatus,
    ):
        say(f"participant's screen: {screen.address}")
        say(f"keys here: {KEYS}")
        reset = (lambda: None) if apparatus is None else apparatus.runner.reset
        experimenter = Experimenter(keys, reset=reset)
        presenter = DevicePresenter(folder, apparatus, screen, experimenter)
        try:
            presenter.welcome(session)
            conduct(folder, participant, session, presenter, counts)
        except SessionStoppedError as stop:
            stopped = str(stop)
        except KeyboardInterrupt:
            stopped = "interrupted: zero force was sent; the same command goes on with this session"
    result = {
        "out": str(folder.session_folder(participant, session)),
        "participant": participant,
        "session": session,
        "done": counts["done"],
        "void": counts["void"],
        "stopped": stopped,
    }
    print_result(result, as_json, {name: str(value) for name, value in result.items()})


@click.command("simulate")
@click.argument("study", type=click.Path(path_type=Path))
@click.option("--observers", type=click.IntRange(1, 999), required=True, help="How many people.")
@click.option("--out", type=click.Path(path_type=Path), required=True, help="A new folder.")
@click.option("--seed", type=SEED, default=0, show_default=True, help="Draws the people.")
@json_option
def simulate_study(study: Path, observers: int, out: Path, seed: int, as_json: bool) -> None:
    """Run the planned STUDY with simulated people, who press the emitted C.

    Their thresholds are known (observers.json): what the report finds shows what the study can
    find. Trajectories are kept of the first of them.
    """
    from springpot.host.wings.study.folder import read_folder
    from springpot.host.wings.study.observers.simulate import simulate

    begin_s = time.monotonic()
    folder = read_folder(study)
    with progress_bar("people") as progress:
        task = progress.task_ids[0]
        found = simulate(
            folder, observers, seed, out,
            lambda done, of: progress.update(task, completed=done, total=of),
        )  # fmt: skip
    result = {
        "out": str(found.folder.path),
        "observers": observers,
        "trials": found.trials,
        "seconds": round(time.monotonic() - begin_s, 3),
    }
    rows = {"study": str(found.folder.path), "people": str(observers), "trials": str(found.trials),
            "took": f"{result['seconds']:.0f} s"}  # fmt: skip
    print_result(result, as_json, rows)


@click.command("report")
@click.argument("study", type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(path_type=Path), help="Folder; by default STUDY/report.")
@click.option("--bids", type=click.Path(path_type=Path), help="A new folder for a BIDS data set.")
@json_option
def report_study(study: Path, out: Path | None, bids: Path | None, as_json: bool) -> None:
    """Open the key of STUDY; write a page and tables of its results.

    It can be asked for at any time: what the answers do not suffice for yet is named. Whoever reads
    it knows what was behind every code.
    """
    from springpot.host.wings.study.report.page import write_study_report

    result = write_study_report(study, out, bids)
    rows = {
        "report": result["out"],
        "tables": ", ".join(result["tables"]),
        "people": f"{result['people']}, {len(result['excluded'])} of them left out",
        "trials": str(result["trials"]),
    }
    if bids is not None:
        rows["BIDS"] = str(bids)
    print_result(result, as_json, rows)


_COMMANDS = {
    "plan": plan_study,
    "run": run_study,
    "simulate": simulate_study,
    "report": report_study,
}


@click.group(cls=LazyGroup, find_commands=lambda: _COMMANDS)
def study() -> None:
    """Does it feel like the object? Plan a study, run it with people, and report."""
