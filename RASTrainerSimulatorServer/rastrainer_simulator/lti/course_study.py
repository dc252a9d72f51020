"""The study as courses use it: who launches becomes a trainee, and trials become grades."""

from __future__ import annotations

import dataclasses
import functools
from datetime import timedelta
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.study.database import study_trainees
from rastrainer.study.database.database import StudyPlace, beside_study
from rastrainer.study.database.study import Study
from rastrainer.study.database.values import moment, utc_now
from rastrainer.study.platform_links import LinkedAssignment, PlatformLinks
from rastrainer.study.study_data import TrialRow, trial_rows
from rastrainer_simulator.lti.launch_message import GradeTerms, PlatformLaunch

FOLLOWED_DAYS = 180
"""After a link was opened last, for which its course is sent new grades."""


@dataclasses.dataclass(frozen=True)
class CourseMember:
    """What the page after a launch shows.

    Attributes:
        pseudonym: In the study.
        trials: That count for the link, in order.
        grade: That the course gets, 0 to 100; None if none yet.
    """

    pseudonym: str
    trials: tuple[TrialRow, ...]
    grade: float | None


@dataclasses.dataclass(frozen=True)
class DueGrade:
    """A grade that a platform has not confirmed.

    Attributes:
        assignment: Where it goes.
        score: 0 to 100.
    """

    assignment: LinkedAssignment
    score: float


class CourseStudy:
    """A study and its links to platforms; for one thread."""

    def __init__(self, place: StudyPlace) -> None:
        """Open an existing study.

        Raises:
            InputError: there is none, or it cannot be used.
        """
        if isinstance(place, Path) and not place.is_file():
            raise InputError(f"There is no study {place}; make it in 3D Slicer first.")
        self._study = Study.open(place, must_exist=True)
        self._links = PlatformLinks(beside_study(place))

    def close(self) -> None:
        """Close it."""
        self._study.close()

    def member(self, launch: PlatformLaunch) -> CourseMember:
        """Return a learner's trainee, who is new in the study at the first launch.

        Raises:
            InputError: the study or its links cannot be written.
        """
        self.forget_deleted()
        issuer, subject = launch.platform.issuer, launch.subject
        pseudonym = self._links.pseudonym(issuer, subject)
        if pseudonym is None:
            # Consent to research is asked for in the lab, not by a course.
            pseudonym = self._study.create_trainee().pseudonym
            try:
                self._links.link(issuer, subject, pseudonym)
            except InputError:
                # Otherwise each further click would add a trainee whom nobody is.
                self._study.delete_trainee(pseudonym)
                raise
        if launch.line_item:
            self._links.put(_assignment(launch))
        terms = launch.terms
        rows = trial_rows(self._study.history(pseudonym))
        counting = tuple(
            row
            for row in rows
            if row.number
            and terms.task in ("", row.task)
            and terms.mode in ("", row.mode)
            and row.method == terms.method.value
        )
        return CourseMember(pseudonym, counting, terms.grade(self._study.past_trials(pseudonym)))

    def due(self) -> list[DueGrade]:
        """Return the grades that platforms have not confirmed.

        Raises:
            InputError: the study or its links cannot be read.
        """
        self.forget_deleted()
        earliest = moment(utc_now()) - timedelta(days=FOLLOWED_DAYS)
        past_trials = functools.cache(self._study.past_trials)
        found = []
        for pseudonym, assignment in self._links.assignments():
            if moment(assignment.launched_utc) < earliest:
                continue
            score = GradeTerms.of(assignment).grade(past_trials(pseudonym))
            if score is not None and round(score, 2) != assignment.sent_score:
                found.append(DueGrade(assignment, round(score, 2)))
        return found

    def note_sent(self, grade: DueGrade, utc: str) -> None:
        """Remember that a platform has confirmed a grade.

        Raises:
            InputError: the links cannot be written.
        """
        self._links.note_sent(grade.assignment, grade.score, utc)

    def forget_deleted(self) -> None:
        """Forget the users whose trainees were deleted from the study, on whatever computer."""
        # First: whoever is linked meanwhile is already a trainee, and is not forgotten.
        linked = self._links.pseudonyms()
        with self._study.database.reading() as connection:
            both = [study_trainees.listed(connection, archived) for archived in (False, True)]
        known = {trainee.pseudonym for trainees in both for trainee in trainees}
        for pseudonym in linked - known:
            self._links.forget(pseudonym)


def _assignment(launch: PlatformLaunch) -> LinkedAssignment:
    terms = launch.terms
    return LinkedAssignment(
        launch.platform.issuer,
        launch.platform.client_id,
        launch.subject,
        launch.line_item,
        terms.task,
        terms.mode,
        terms.method.value,
        terms.rule.value,
        utc_now(),
    )
