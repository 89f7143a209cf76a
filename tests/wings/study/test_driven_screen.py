"""The participant's screen in a browser, with nothing but a keyboard."""

import time
from collections.abc import Iterator
from dataclasses import replace

import pytest
from support.browser import NEEDS_CHROMIUM
from support.driven_browser import DrivenBrowser, driven_browser

from springpot.host.native.loop_library import COLUMN, LoopRows, empty_rows
from springpot.host.wings.pages.server import PageEvent
from springpot.host.wings.study.session.screen import ParticipantScreen
from springpot.host.wings.study.session.screen_state import Act, Ask, ScreenState

pytestmark = [pytest.mark.realtime, NEEDS_CHROMIUM]

RATE = Ask("number", "How alike are they?")
TRIAL = ScreenState(
    "Trial 1 of 24", "Feel both.", ("Left", "Right"), active=0, ask=RATE, guideline_m=0.008
)
ABX = ScreenState(
    "Trial 2 of 24", "X is A or B.", ("A", "B", "X"), ask=Ask("choice", "X is:", choices=("A", "B"))
)
WORDS = ScreenState("Question 1 of 5", "Please answer.", ask=Ask("text", "What did you feel for?"))
READY = ScreenState("Welcome", "Press the space bar.")
NARROW = (400, 800)
CALM_S = 0.5  # more than the page wants after a new question
GONE = "The session has ended or was interrupted. Please wait for the experimenter."


class Seat:
    """A participant in front of the screen."""

    def __init__(self, screen: ParticipantScreen, browser: DrivenBrowser) -> None:
        self.screen, self.browser = screen, browser

    def sit(self, width: int = 1600, height: int = 900) -> None:
        self.browser.open(self.screen.address, width, height)
        self.browser.until("document.body?.dataset.deepestM !== undefined")

    def see(self, state: ScreenState) -> None:
        """It is shown, was read, and is whole."""
        self.screen.show(state)
        self.sees("title", state.title)
        self.sees("instruction", state.instruction)
        time.sleep(CALM_S)
        assert self.browser.value(
            "document.documentElement.scrollWidth <= innerWidth"
            " && document.querySelector('main').scrollHeight <= innerHeight"
        )

    def sees(self, name: str, text: str) -> None:
        self.browser.until(f"document.getElementById('{name}')?.textContent === {text!r}")

    @property
    def typed(self) -> str:
        return str(self.browser.value("document.getElementById('typed').value"))

    @property
    def answering(self) -> bool:
        return not self.browser.value("document.getElementById('answer').hidden")

    def press(self, *keys: str) -> None:
        self.browser.press(*keys)

    def act(self) -> Act | None:
        return self.screen.next_act(10.0)

    def no_act(self) -> bool:
        return self.screen.next_act(0.2) is None


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[DrivenBrowser]:
    with driven_browser(tmp_path_factory.mktemp("browser")) as found:
        yield found


@pytest.fixture
def seat(browser: DrivenBrowser) -> Iterator[Seat]:
    with ParticipantScreen() as screen:
        browser.errors.clear()
        yield Seat(screen, browser)
        assert browser.errors == []
        fetched = browser.value("performance.getEntriesByType('resource').map((one) => one.name)")
        assert all(one.startswith(screen.address) for one in fetched), fetched


def rows_at(position_m: float) -> LoopRows:
    rows = empty_rows(1)
    rows[:, COLUMN["position_m"]] = position_m
    return rows


def broken() -> Iterator[PageEvent]:
    raise OSError


def test_a_number(seat: Seat) -> None:
    seat.sit()
    seat.see(READY)
    seat.press("x", "Enter")
    assert seat.act() == Act("next", 0)
    seat.see(TRIAL)
    seat.sees("question", RATE.question)
    seat.press(" ", "5", "ArrowLeft", "1")  # nothing of that changes anything
    assert seat.no_act()
    seat.press("ArrowRight")
    assert seat.act() == Act("slot", 1)
    seat.screen.show(replace(TRIAL, wanted=1))
    seat.sees("change", "For Right: lift the tool off the surface.")
    seat.screen.show(replace(TRIAL, active=1))
    seat.sees("change", "Under the tool: Right")
    seat.press("1")
    assert seat.act() == Act("slot", 0)
    seat.press("Enter", "1", "x", "7", "0")
    assert seat.typed == "170"
    seat.press("Enter")
    assert seat.browser.text("said") == "Please type a number from 0 to 100."
    seat.press("Escape")
    assert not seat.answering
    seat.press("Enter", "Enter")
    assert seat.browser.text("said") == "Please type a number from 0 to 100."
    seat.press("7", "1", "Backspace", "0")
    assert seat.no_act()
    seat.press("Enter")
    assert seat.act() == Act("answer", "70")
    seat.sees("said", "Thank you.")


def test_a_choice(seat: Seat) -> None:
    seat.sit(*NARROW)
    seat.see(ABX)
    seat.press("3")
    assert seat.act() == Act("slot", 2)
    seat.press("Enter", "Enter")
    assert seat.browser.text("said") == "Please choose one of the 2."
    seat.press("3", "2", "ArrowUp", "ArrowUp", "ArrowDown")
    assert seat.browser.value("document.querySelector('[aria-selected=true]').textContent") == "2B"
    assert seat.browser.value("document.activeElement.textContent") == "2B"
    assert seat.no_act()
    seat.press("Enter")
    assert seat.act() == Act("answer", "B")


def test_words(seat: Seat) -> None:
    seat.sit(*NARROW)
    seat.see(WORDS)
    seat.press("Enter")
    assert seat.browser.text("said").startswith("Please type something")
    seat.press(*"no 1", "Escape", *"Soft, ")
    seat.browser.call("Input.insertText", text="부드러움")
    seat.press(" ", *"2x", "Enter")
    assert seat.act() == Act("answer", "Soft, 부드러움 2x")


def test_a_second_enter_or_a_key_that_is_held_down_answers_nothing(seat: Seat) -> None:
    def hold() -> None:
        for _ in range(3):
            seat.browser.call(
                "Input.dispatchKeyEvent", type="keyDown", key="Enter", autoRepeat=True
            )

    seat.sit()
    seat.see(READY)
    hold()
    assert seat.no_act()
    seat.press("Enter")
    assert seat.act() == Act("next", 0)
    seat.see(TRIAL)
    hold()
    assert not seat.answering
    seat.press("Enter", "7", "Enter", "Enter", "Enter")
    assert seat.act() == Act("answer", "7")
    seat.screen.show(replace(TRIAL, title="Trial 2 of 24"))
    seat.sees("title", "Trial 2 of 24")
    seat.press("Enter", "7", "Enter")  # sooner than anybody reads
    assert not seat.answering
    seat.see(READY)
    assert seat.no_act()


def test_what_is_typed_stays_while_the_thing_under_the_tool_changes(seat: Seat) -> None:
    seat.sit()
    seat.see(replace(TRIAL, wanted=1))
    seat.press("Enter", "7")
    seat.screen.show(replace(TRIAL, active=1))
    seat.sees("change", "Under the tool: Right")
    seat.press("5", "Enter")
    assert seat.act() == Act("answer", "75")
    seat.see(replace(TRIAL, active=1))  # the same trial comes again: nothing is left of the answer
    assert not seat.answering
    seat.press("Enter")
    assert seat.typed == ""


def test_a_page_that_was_reloaded_goes_on(seat: Seat) -> None:
    seat.sit()
    seat.see(TRIAL)
    seat.press("Enter", "7")
    seat.sit()
    seat.sees("title", TRIAL.title)
    time.sleep(CALM_S)
    assert not seat.answering
    seat.press("Enter", "8", "Enter")
    assert seat.act() == Act("answer", "8")
    seat.sit()  # it was answered: nothing more can be said
    seat.sees("title", TRIAL.title)
    time.sleep(CALM_S)
    seat.press("Enter", "9", "Enter")
    assert seat.no_act()
    assert not seat.answering


def test_a_warning_is_read_and_heard_and_goes(seat: Seat) -> None:
    seat.sit()
    seat.see(TRIAL)
    seat.press("x")  # a browser lets nothing sound before a key
    time.sleep(CALM_S)
    seat.screen.warn("Slower, please: keep to the pace you were shown.")
    seat.sees("warning", "Slower, please: keep to the pace you were shown.")
    assert seat.browser.value("document.body.dataset.tones") == "2"
    assert seat.browser.value("getComputedStyle(document.getElementById('warning')).display") != (
        "none"
    )
    seat.sees("warning", "")


def test_the_tip_moves_smoothly_and_the_guideline_says_too_deep(seat: Seat) -> None:
    seat.sit()
    seat.see(TRIAL)
    deep = "document.getElementById('picture').classList.contains('deep')"
    seat.screen.append(rows_at(0.0079))
    seat.browser.until("document.body.dataset.moves > 0")
    assert not seat.browser.value(deep)
    begin = int(seat.browser.value("document.body.dataset.moves"))
    begin_s = time.monotonic()
    for k in range(100):  # as the rows of a session come
        seat.screen.append(rows_at(1e-5 * k))
        time.sleep(0.02)
    took_s = time.monotonic() - begin_s
    moves = int(seat.browser.value("document.body.dataset.moves")) - begin
    assert moves / took_s > 25.0  # what the eye takes for motion
    seat.screen.append(rows_at(0.0081))
    seat.browser.until(deep)


def test_a_connection_that_breaks_is_taken_up_again_and_an_end_is_said(
    seat: Seat, monkeypatch: pytest.MonkeyPatch
) -> None:
    seat.sit()
    seat.see(TRIAL)
    seat.press("Enter", "7")
    (page,) = seat.screen.watchers()
    monkeypatch.setattr(page, "news", broken)
    seat.sees("gone", GONE)
    seat.sees("gone", "")
    seat.press("5", "Enter")
    assert seat.act() == Act("answer", "75")
    seat.screen.end("Thank you.")
    seat.sees("gone", "Thank you.")
