"""A study of virtual trainees who practice what their curriculum says comes next."""

from __future__ import annotations

import random
import uuid
from datetime import datetime, timedelta, timezone
from pathlib import Path
from typing import Any

from rastrainer.protocol import TRACED_METHODS
from rastrainer.study.curriculum.curriculum import Curriculum
from rastrainer.study.curriculum.curriculum_store import CurriculumStore
from rastrainer.study.curriculum.standing import standing_in
from rastrainer.study.database.database import StudyPlace
from rastrainer.study.database.study import Study
from rastrainer.study.database.values import day_of
from rastrainer.study_messages import Assignment
from rastrainer.trial.scoring import PASS_MARK
from Testing.domain.trial.trial_records import gentle_score, make_record, make_traced

SHIPPED = Path(__file__).parents[3] / "assets" / "studies" / "example-curriculum.json"
FIRST_DAY = datetime(2026, 11, 2, 9, 0, tzinfo=timezone.utc)


def play_class(
    place: StudyPlace, names: list[str], trials: int, curriculum: Curriculum | None = None
) -> None:
    """Have each trainee practice up to a number of trials, from their own tempo, by a seed."""
    rng, follows = random.Random(23), curriculum or Curriculum.read(SHIPPED)
    with Study.open(place) as study:
        CurriculumStore(study).choose(follows)
        # In one transaction: a trial alone costs a sync of the disk.
        with study.database.writing():
            for name in names:
                study.create_trainee(name, consent=True)
                _practice(study, name, follows, rng.randint(0, trials), rng)


def _practice(
    study: Study, name: str, follows: Curriculum, trials: int, rng: random.Random
) -> None:
    tempo_s = rng.uniform(90.0, 190.0)
    for number in range(trials):
        standing = standing_in(follows, study.attempts(name), lambda _: PASS_MARK)
        best = standing.next_best
        if best is None or best.procedure:
            return
        seconds = tempo_s * (number + 1) ** -0.3 * rng.uniform(0.8, 1.25)
        _play(study, name, best, seconds, number, rng)


def _play(
    study: Study, name: str, assignment: Assignment, seconds: float, number: int, rng: random.Random
) -> None:
    """Store a scored trial, the trainee's `number`-th; three are played on each second day."""
    started = (FIRST_DAY + timedelta(days=2 * (number // 3), minutes=4 * (number % 3))).isoformat()
    make = make_traced if assignment.method in TRACED_METHODS else make_record
    value = make(
        trialId=str(uuid.UUID(int=rng.getrandbits(128))),
        trainee=name,
        task=assignment.task,
        startedUtc=started,
        completedUtc=started,
        method=assignment.method,
    )
    study.add_trial(value, score=gentle_score(seconds, 0.25))


def as_in_narrow_columns(cell: dict[str, Any]) -> str:
    """Return what report, module and command show where the board's table has this cell."""
    return f"{cell['progress'].replace(' / ', ' of ')} {day_of(cell['reachedUtc'])}".rstrip()
