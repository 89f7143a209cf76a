"""What people are asked, by method."""

from springpot.host.wings.study.definition import Study
from springpot.host.wings.study.session.screen_state import Ask

_QUESTIONS = {
    "similarity": "How similar are the two? 0: entirely different. 100: the same.",
    "constant": "Which one is stiffer?",
    "staircase": "Which one is stiffer?",
    "quest+": "Which one is stiffer?",
    "abx": "Which one is the same as X?",
    "same-different": "Are the two the same, or different?",
}
TOO_DEEP, TOO_FAST = "Less deep, please.", "Slower, please."
FEEL_ALL = "Please press all of them before you answer."


def slots(study: Study) -> tuple[str, ...]:
    """Names of what can be felt in a trial, left to right."""
    return ("A", "B", "X") if study.method == "abx" else ("Left", "Right")


def answers(study: Study) -> tuple[str, ...]:
    """What can be answered; none: a number from 0 to 100."""
    if study.method == "similarity":
        return ()
    if study.method == "abx":
        return "A", "B"
    return ("same", "different") if study.method == "same-different" else ("left", "right")


def trial_question(study: Study) -> Ask:
    """What the screen asks in a trial."""
    question = study.ask or _QUESTIONS[study.method]
    choices = answers(study)
    return Ask("choice" if choices else "number", question, choices=choices)
