"""A small study: two materials with one method, of stored models; people who type and rate."""

import shutil
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from springpot import Scene
from springpot.host.files import write_scene
from springpot.host.study.definition import RENDERED
from springpot.host.study.plan import StudyPlan, append_only_table, write_plan
from springpot.host.study.session import ANSWER_COLUMNS, RESPONSE_COLUMNS
from support.paths import TESTS

SOFT, HARD = "ecoflex-00-30", "dragon-skin-10"
DEVICE = f"sim://{SOFT}?hand=mid"
STUDY = f"""
schema = 1
name = "small"
seed = 3
sessions = 2
practice = 1
lower_bound = ["soft", "hard"]
lower_bound_trials = 2
exclude_repeat_sd_above = 25.0
exclude_side_difference_above = 25.0
questions = ["Did it shake?", "What else?"]

[[material]]
name = "soft"
scenes.passive = "{SOFT}.toml"

[[material]]
name = "hard"
scenes.passive = "{HARD}.toml"
"""


def planned_study(folder: Path, participants: int = 2) -> StudyPlan:
    for name in (SOFT, HARD):
        shutil.copyfile(TESTS / "golden" / "press" / f"{name}.spm", folder / f"{name}.spm")
        write_scene(folder / f"{name}.toml", Scene(schema=1, name=name, model=f"{name}.spm"))
    (folder / "study.toml").write_text(STUDY)
    return write_plan(folder / "study.toml", participants, folder / "plan")


@dataclass
class Typist:
    """Standard input of somebody who presses for a while before each line."""

    lines: list[str]
    seconds: float = 0.4

    def readline(self) -> str:
        time.sleep(self.seconds)
        return self.lines.pop(0) + "\n" if self.lines else ""


def rate_study(plan: StudyPlan, shift: dict[str, float]) -> None:
    """Everybody rates; 04 and 13 scatter widely, 06 and 13 take sides. shift: points by method."""
    rng = np.random.default_rng(1)
    for person in plan.participants:
        level = rng.normal(80.0, 5.0)
        plan.folder(person).mkdir(exist_ok=True)
        own = [trial for trial in plan.trials if trial.participant == person]
        with append_only_table(plan.folder(person) / "responses.csv", RESPONSE_COLUMNS) as (
            _,
            append,
        ):
            for trial in own:
                rating = level + shift.get(trial.method, 0.0) + rng.normal(0.0, 5.0)
                if person in ("04", "13"):
                    rating = (5.0, 95.0, 20.0)[int(trial.session) % 3]
                if person in ("06", "13") and RENDERED in (trial.left, trial.right):
                    rating = rating / 2 + 50.0 if trial.left == RENDERED else rating / 2
                rating = float(np.clip(rating, 0.0, 100.0)) if trial.session != "0" else 0.0
                append([*trial, f"{rating:g}", "9.0", 0, ""])
        with append_only_table(plan.folder(person) / "answers.csv", ANSWER_COLUMNS) as (_, append):
            append([person, plan.study.questions[0], "no" if person < "05" else "yes"])
