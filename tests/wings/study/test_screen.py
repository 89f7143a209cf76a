"""The participant's screen over plain HTTP: what is shown, what counts, and what never does."""

import http.client
import json
import urllib.error
import urllib.request
from collections.abc import Iterator
from typing import IO, Any

import numpy as np
import pytest
from support.browser import answer_of

from springpot.host.native.loop_library import COLUMN, NONE, LoopRows, empty_rows
from springpot.host.wings.study.session.screen import ParticipantScreen
from springpot.host.wings.study.session.screen_state import LONGEST_TEXT, Act, Ask, ScreenState

RATE = Ask("number", "How alike?")
TRIAL = ScreenState("Trial 1 of 2", "Feel both.", ("Left", "Right"), active=0, ask=RATE)
READY = ScreenState("Welcome", "Press the space bar.")


@pytest.fixture
def screen() -> Iterator[ParticipantScreen]:
    with ParticipantScreen() as found:
        yield found


def acted(screen: ParticipantScreen, number: int, kind: str, value: Any) -> bool | None:
    """Tell whether the screen accepts an act for a state; None if it refuses to read it."""
    body = json.dumps({"state": number, "kind": kind, "value": value}).encode()
    status, content = answer_of(screen.address + "act", body)
    return None if status == 400 else json.loads(content)["accepted"]


def looking(screen: ParticipantScreen) -> IO[bytes]:
    return urllib.request.urlopen(screen.address + "events", timeout=10)


def next_event(stream: IO[bytes], name: str) -> Any:
    """Data of the next event of that name."""
    while True:
        found, data, _ = (stream.readline().decode().rstrip("\n") for _ in range(3))
        if found == f"event: {name}":
            return json.loads(data.removeprefix("data: "))


def rows_at(*positions_m: float, call: int = 0) -> LoopRows:
    rows = empty_rows(len(positions_m))
    rows[:, COLUMN["position_m"]] = positions_m
    rows[:, COLUMN["call"]] = call
    return rows


def test_the_page_is_whole_and_names_no_other_place(screen: ParticipantScreen) -> None:
    text = answer_of(screen.address)[1].decode()
    assert "http" not in text
    assert text.count("<script") == 1
    assert len(text) < 25_000


def test_a_page_gets_the_state_now_and_every_further_one(screen: ParticipantScreen) -> None:
    screen.show(TRIAL)
    with looking(screen) as stream:
        found = next_event(stream, "state")
        assert (found["number"], found["title"], found["answered"]) == (1, "Trial 1 of 2", False)
        assert (found["slots"], found["active"], found["wanted"]) == (["Left", "Right"], 0, None)
        assert found["ask"]["question"] == "How alike?"
        screen.show(READY)
        assert next_event(stream, "state")["number"] == 2
    with looking(screen) as stream:  # a reloaded page
        assert next_event(stream, "state")["instruction"] == "Press the space bar."


def test_acts_come_in_order_and_once(screen: ParticipantScreen) -> None:
    screen.show(TRIAL)
    assert acted(screen, 1, "slot", 1)
    assert acted(screen, 1, "slot", 0)
    assert acted(screen, 1, "answer", "070")
    assert acted(screen, 1, "answer", "71") is False
    assert acted(screen, 1, "slot", 1) is False
    found = [screen.next_act(1.0) for _ in range(4 - 1)]
    assert found == [Act("slot", 1), Act("slot", 0), Act("answer", "070")]
    assert screen.next_act(0.0) is None


def test_an_act_for_another_state_is_dropped(screen: ParticipantScreen) -> None:
    screen.show(TRIAL)
    screen.show(TRIAL)
    for number in (0, 1, 3):
        assert acted(screen, number, "answer", "70") is False
    assert screen.next_act(0.0) is None
    assert acted(screen, 2, "answer", "70")


@pytest.mark.parametrize(
    ("ask", "right", "wrong"),
    [
        (RATE, ["0", "100", "007"], ["101", "-1", "", "5.5", " 5", "1e1", "٣", "nan", "9" * 12]),
        (Ask("number", "?", -5, 5), ["-5", "5"], ["-6", "--5"]),
        (Ask("choice", "?", choices=("yes", "no")), ["yes", "no"], ["Yes", "", "maybe", "1"]),
        (Ask("text", "?"), ["-", "a" * LONGEST_TEXT], ["", "  ", "a" * (LONGEST_TEXT + 1)]),
    ],
)
def test_only_what_a_question_asks_is_an_answer(
    screen: ParticipantScreen, ask: Ask, right: list[str], wrong: list[str]
) -> None:
    for typed in right:
        screen.show(ScreenState("Trial", "Answer.", ask=ask))
        number = screen.newest()[0][0]
        for other in [*wrong, 70, None, True]:
            assert acted(screen, number, "answer", other) is None, other
        assert acted(screen, number, "next", 0) is None
        assert acted(screen, number, "answer", typed)
        assert screen.next_act(0.0) == Act("answer", typed)


def test_what_cannot_be_done_in_a_state_is_refused(screen: ParticipantScreen) -> None:
    screen.show(TRIAL)
    for value in (-1, 2, "0", 0.5, True, None):
        assert acted(screen, 1, "slot", value) is None, value
    assert acted(screen, 1, "next", 0) is None
    screen.show(READY)
    assert acted(screen, 2, "slot", 0) is None
    assert acted(screen, 2, "answer", "70") is None
    assert acted(screen, 2, "next", "x") is None
    assert screen.next_act(0.0) is None


@pytest.mark.parametrize(
    "body",
    [b"", b"{}", b"[1]", b"null", b"\xff", b"{" * 4000, b'{"state":1,"kind":"next"}',
     b'{"state":"1","kind":"next","value":0}', b'{"state":1,"kind":"stop","value":0}',
     b'{"state":1,"kind":"next","value":0,"more":1}', b'{"state":1.5,"kind":"next","value":0}',
     b'{"state":1,"kind":"next","value":0} x'],
)  # fmt: skip
def test_a_body_that_is_no_act_is_refused(screen: ParticipantScreen, body: bytes) -> None:
    screen.show(READY)
    assert answer_of(screen.address + "act", body)[0] == 400
    assert screen.next_act(0.0) is None


@pytest.mark.parametrize("size", ["8193", "99999999999999999999", "-1", "1 2", "x", "٣"])
def test_a_body_that_is_too_large_is_not_even_read(screen: ParticipantScreen, size: str) -> None:
    where = urllib.request.Request(screen.address)
    connection = http.client.HTTPConnection(where.host, timeout=10)
    connection.putrequest("POST", where.selector + "act")
    connection.putheader("Content-Length", size.encode())
    connection.endheaders()
    assert connection.getresponse().status == 400
    connection.close()


def test_the_newest_position_is_shown(screen: ParticipantScreen) -> None:
    with looking(screen) as stream:
        assert next_event(stream, "position") is None
        screen.append(rows_at(0.001, 0.002, 0.003))
        assert next_event(stream, "position") == 0.003
        screen.append(rows_at(0.004, np.nan))
        assert next_event(stream, "position") == 0.004
        screen.append(rows_at(0.009, call=NONE))  # nothing was called: no position of the tool
        screen.append(rows_at())
        screen.append(rows_at(0.005))
        assert next_event(stream, "position") == 0.005


def test_a_warning_is_for_those_who_look_now(screen: ParticipantScreen) -> None:
    screen.warn("Too deep.")
    with looking(screen) as stream:
        next_event(stream, "state")
        screen.warn("Slower,\nplease.")
        assert next_event(stream, "warning") == "Slower,\nplease."
        screen.warn("Slower,\nplease.")
        assert next_event(stream, "warning") == "Slower,\nplease."


def test_a_slow_page_gets_the_newest_of_all(screen: ParticipantScreen) -> None:
    page = screen.watcher()
    assert [name for name, _ in page.news()] == ["state", "position"]
    for k in range(1, 1001):
        screen.append(rows_at(k * 1e-6))
    screen.show(TRIAL)
    screen.show(READY)
    (state, content), position = page.news()
    assert (state, json.loads(content)["number"]) == ("state", 2)
    assert position == ("position", "0.001")
    assert list(page.news()) == []


def test_a_guideline_outside_the_picture_is_refused(screen: ParticipantScreen) -> None:
    screen.show(ScreenState("Trial", "Feel.", ("Left",), guideline_m=0.012))
    for guideline_m in (0.0121, 0.0, -0.001, float("nan")):
        with pytest.raises(ValueError, match="guideline_m"):
            screen.show(ScreenState("Trial", "Feel.", ("Left",), guideline_m=guideline_m))
