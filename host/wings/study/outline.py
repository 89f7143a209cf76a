"""What a planned study takes: trials, minutes, objects, and what so many people can find."""

from typing import Any

from springpot.host.wings.study.definition import Study
from springpot.host.wings.study.folder import KEY, StudyFolder
from springpot.host.wings.study.schedule import fixed_trials, williams_rows


def outline(folder: StudyFolder) -> dict[str, Any]:
    """Return keys of `springpot study plan --json`."""
    study = folder.study
    trials = None if study.adaptive else len(fixed_trials(study, 1, 1))
    real = {stimulus.name: stimulus.real for stimulus in study.stimulus if stimulus.real}
    stickers = folder.key.stickers
    by_sticker = sorted(real, key=lambda name: int(stickers[name][1:]))
    return {
        "out": str(folder.path),
        "participants": len(folder.participants),
        "sessions": study.sessions,
        "practice": study.practice,
        "trials": trials,
        "minutes": None if trials is None else trials * study.trial_minutes,
        "order": _order(study, len(folder.participants)),
        "conditions": len(study.pair),
        "blind": sum(could_be_blind(study, k) for k in range(len(study.pair))),
        "stickers": {stickers[name]: real[name] for name in by_sticker},
        "power": _power(study, len(folder.participants)),
        "key": str(folder.path / KEY),
    }


def could_be_blind(study: Study, pair: int) -> bool:
    """Return whether nobody in the room could know what is what: both stimuli are scenes."""
    both = (study.pair[pair].left, study.pair[pair].right)
    return all(study.stimulus_of(name).scene is not None for name in both)


def _order(study: Study, participants: int) -> str:
    if study.adaptive:
        return f"{study.method}: levels follow the answers"
    if study.order == "random":
        return "random for every session and participant"
    rows = len(williams_rows(len(study.pair)))
    sessions = participants * study.sessions
    if sessions % rows == 0:
        return f"Williams: each condition follows each other {sessions // rows} times"
    return (
        f"Williams: {sessions} sessions do not fill its {rows} orders equally often; take a "
        f"multiple of {rows} sessions"
    )


def _power(study: Study, participants: int) -> dict[str, Any] | None:
    """Return the share of studies that find the margin, if the file says what to expect."""
    margin = study.equivalence
    if margin is None or margin.sd is None:
        return None
    from springpot.host.wings.study.statistics.power import difference_power, equivalence_power

    effect = margin.margin / margin.sd
    alike = equivalence_power(participants, effect)
    differs = difference_power(participants, effect)
    return {
        "margin": margin.margin,
        "sd": margin.sd,
        "equivalent": alike,
        "different": differs,
        "line": f"of studies like this, {100 * alike:.0f} % show that two conditions without a "
        f"difference are alike within {margin.margin:g}, {100 * differs:.0f} % find a difference "
        "of that size",
    }
