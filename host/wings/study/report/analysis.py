"""A whole study's results: of everybody, and without those whom its rules leave out."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from springpot.host.wings.study.definition import Study
from springpot.host.wings.study.report.choices import (
    PsychometricCurve,
    psychometric_curves,
    psychometric_rows,
    sensitivity_rows,
)
from springpot.host.wings.study.report.comparisons import Comparisons, Row, compare
from springpot.host.wings.study.report.scores import Consistency, consistency
from springpot.host.wings.study.responses import Reply, Response

_COMPARED = ("anova", "simple", "pairs", "equivalence", "power", "agreement", "notes")


@dataclass(frozen=True, eq=False)
class Analysis:
    """responses: of all sessions but practice. kept: of whom the rules leave in. excluded: rows of
    the others; whole, kept_only: comparisons of everybody and of those left in, similarity only."""

    study: Study
    responses: Sequence[Response]
    kept: Sequence[Response]
    people: Sequence[Consistency]
    whole: Comparisons | None
    kept_only: Comparisons | None
    curves: Sequence[PsychometricCurve] = ()
    sensitivity: Sequence[Row] = ()
    questions: Sequence[Row] = ()
    psychometric: Sequence[Row] = field(default_factory=list)

    @property
    def excluded(self) -> list[Consistency]:
        return [person for person in self.people if person.broken]

    def as_dict(self) -> dict[str, Any]:
        """Return keys of `study report --json`, without where it was written.

        Comparisons are of those left in; `everybody` holds the same of everybody."""
        return {
            "trials": len(self.responses),
            "people": len({response.participant for response in self.responses}),
            "excluded": [vars(person) for person in self.excluded],
            **_compared(self.kept_only),
            "psychometric": list(self.psychometric),
            "sensitivity": list(self.sensitivity),
            "questions": list(self.questions),
            "everybody": _compared(self.whole),
        }


def analyse(study: Study, responses: Sequence[Response], replies: Sequence[Reply]) -> Analysis:
    """Analyse the answers so far."""
    counted = [response for response in responses if response.session > 0]
    questions = question_rows(study, replies)
    if study.method != "similarity":
        curves = psychometric_curves(study, counted)
        return Analysis(
            study, counted, counted, (), None, None, curves, sensitivity_rows(study, counted),
            questions, psychometric_rows(curves),
        )  # fmt: skip
    people = consistency(study, counted)
    left = {person.participant for person in people if person.broken}
    kept = [response for response in counted if response.participant not in left]
    whole = compare(study, counted)
    return Analysis(
        study, counted, kept, people, whole, compare(study, kept) if left else whole,
        questions=questions,
    )  # fmt: skip


def question_rows(study: Study, replies: Sequence[Reply]) -> list[Row]:
    """Count each answer: choices in the file's order, words most often first."""
    rows: list[Row] = []
    for number, question in enumerate(study.question):
        counts: Counter[str] = Counter(dict.fromkeys(question.choices, 0))
        counts.update(reply.answer.strip() for reply in replies if reply.question == number)
        of = sum(counts.values())
        rows += [
            {"question": question.text, "answer": answer, "count": count, "of": of}
            for answer, count in (counts.items() if question.choices else counts.most_common())
        ]
    return rows


def _compared(found: Comparisons | None) -> Mapping[str, Any]:
    empty: dict[str, Any] = {name: [] for name in _COMPARED}
    if found is None:
        return empty | {"power": None}
    return {name: getattr(found, name) for name in _COMPARED}
