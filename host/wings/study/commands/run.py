"""`springpot study run`: the next session of one participant."""

import sys
from contextlib import nullcontext
from pathlib import Path

import click

from springpot import UsageError
from springpot.console import json_option, print_result, say


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
        presenter = DevicePresenter(folder, apparatus, screen, Experimenter(keys))
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
