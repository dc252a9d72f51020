"""The study as courses use it: learners who launch become trainees, and trials grades.

Grades are returned to the learning platforms (Assignment and Grade Services), each until it is
confirmed.
"""

from __future__ import annotations

import asyncio
import dataclasses
import functools
import json
import logging
from collections import Counter
from collections.abc import Callable
from datetime import timedelta
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit, urlunsplit

from rastrainer.errors import InputError
from rastrainer.json_checks import text
from rastrainer.study.database.database import StudyPlace, path_beside_study
from rastrainer.study.database.study import Study
from rastrainer.study.database.values import moment, utc_now
from rastrainer.study.platform_links import LinkedAssignment, PlatformLinks
from rastrainer.study.study_data import TrialRow, trial_rows
from rastrainer_simulator.lti.launch_message import SCORE_SCOPE, GradeTerms, PlatformLaunch
from rastrainer_simulator.lti.platform_client import PlatformClient, PlatformUnreachableError
from rastrainer_simulator.lti.settings import LearningPlatform, LtiSettings, ToolKey
from rastrainer_simulator.ops.study_thread import StudyThread

FOLLOWED_DAYS = 180
"""How long after a link was last opened its course is sent new grades."""


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
        """Open an existing study."""
        if isinstance(place, Path) and not place.is_file():
            raise InputError(f"There is no study {place}; make it in 3D Slicer first.")
        self._study = Study.open(place, must_exist=True)
        self._links = PlatformLinks(path_beside_study(place))

    def close(self) -> None:
        self._study.close()

    def member(self, launch: PlatformLaunch) -> CourseMember:
        """Return a learner's trainee, who is new in the study at the first launch."""
        self.forget_deleted()
        issuer, subject = launch.platform.issuer, launch.subject
        pseudonym = self._links.pseudonym(issuer, subject)
        if pseudonym is None:
            # Consent to research is asked for in the lab, not by a course.
            pseudonym = self._study.create_trainee().pseudonym
            try:
                self._links.link(issuer, subject, pseudonym)
            except InputError:
                # Otherwise each further click would add a trainee without a person.
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
        """Return the grades that platforms have not confirmed."""
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
        """Remember that a platform has confirmed a grade."""
        self._links.note_sent(grade.assignment, grade.score, utc)

    def forget_deleted(self) -> None:
        """Forget the users whose trainees were deleted from the study, on any computer."""
        # First: a user linked meanwhile is already a trainee, and is not forgotten.
        linked = self._links.pseudonyms()
        with self._study.database.reading():
            everyone = (*self._study.trainees(), *self._study.trainees(archived=True))
        known = {trainee.pseudonym for trainee in everyone}
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


_log = logging.getLogger(__name__)
ROUND_S = 5.0
FIRST_RETRY_S, LAST_RETRY_S = 2.0, 300.0
SCORE_TYPE = "application/vnd.ims.lis.v1.score+json"
_ASSERTION = "urn:ietf:params:oauth:client-assertion-type:jwt-bearer"
_RENEWED_BEFORE_S = 60.0


class GradeReturn:
    """Sends what a study has and platforms have not confirmed.

    What is due follows from the study and what was confirmed, so there is no queue that a crash
    could lose.
    """

    def __init__(
        self,
        settings: LtiSettings,
        key: ToolKey,
        client: PlatformClient,
        study: StudyThread[CourseStudy],
        clock: Callable[[], float],
    ) -> None:
        """Send nothing yet.

        Args:
            settings: Of the platforms.
            key: Signs the requests for access.
            client: Asks the platforms.
            study: Has the grades.
            clock: Returns s.
        """
        self._settings, self._key, self._client = settings, key, client
        self._study, self._clock = study, clock
        self._tokens: dict[LearningPlatform, tuple[str, float]] = {}
        self._retry: dict[LearningPlatform, tuple[float, float]] = {}
        self._refused: dict[tuple[str, str, str], float] = {}
        self._failures: Counter[tuple[str, str, str]] = Counter()

    async def run(self) -> None:
        """Send until the task is canceled."""
        while True:
            try:
                await self.send_due()
            except InputError as error:
                _log.warning("Grades wait: %s", error)
            except Exception:
                # Launches continue, and no one would notice that no more grades are sent.
                _log.exception("Grades wait because of an unexpected error")
            await asyncio.sleep(ROUND_S)

    async def send_due(self) -> int:
        """Send once what is due and return how many grades were confirmed."""
        confirmed = 0
        due = await self._study.do(CourseStudy.due)
        # A grade at which a platform always fails comes last, and so delays no other.
        for grade in sorted(due, key=lambda each: self._failures[_key(each)]):
            platform = self._settings.platform(grade.assignment.issuer, grade.assignment.client_id)
            if platform is None or not self._may_send(platform, grade):
                continue
            try:
                confirmed += await self._send(platform, grade)
                self._retry.pop(platform, None)
                self._failures.pop(_key(grade), None)
            except PlatformUnreachableError as error:
                self._failures[_key(grade)] += 1
                self._wait(platform, error)
        return confirmed

    def _may_send(self, platform: LearningPlatform, grade: DueGrade) -> bool:
        is_allowed = platform.sends_grades and platform.takes_grades_at(grade.assignment.line_item)
        is_waited_for = self._retry.get(platform, (0.0, 0.0))[0] > self._clock()
        return is_allowed and not is_waited_for and self._refused.get(_key(grade)) != grade.score

    def _wait(self, platform: LearningPlatform, error: PlatformUnreachableError) -> None:
        pause = min(2.0 * self._retry.get(platform, (0.0, FIRST_RETRY_S / 2.0))[1], LAST_RETRY_S)
        self._retry[platform] = (self._clock() + pause, pause)
        self._tokens.pop(platform, None)
        _log.warning(
            "%s takes no grades now: %s. Nothing is lost; next try in %g s.",
            platform.name,
            error,
            pause,
        )

    async def _send(self, platform: LearningPlatform, grade: DueGrade) -> bool:
        """Send a grade and return whether it was accepted; a refused one delays no other."""
        token = await self._token(platform)
        utc = _after(grade.assignment.sent_utc)
        body = json.dumps(_score(grade, utc)).encode()
        address = scores_url(grade.assignment.line_item)
        status = await self._client.send(address, body, SCORE_TYPE, token)
        if 200 <= status < 300:
            await self._study.do(lambda study: study.note_sent(grade, utc))
            return True
        self._refused[_key(grade)] = grade.score
        _log.warning(
            "%s refuses a grade (status %d); it is sent again with the next score, or after a "
            "restart.",
            platform.name,
            status,
        )
        return False

    async def _token(self, platform: LearningPlatform) -> str:
        token, until = self._tokens.get(platform, ("", 0.0))
        if token and self._clock() < until:
            return token
        audience = platform.token_audience or platform.token_url
        form = {
            "grant_type": "client_credentials",
            "client_assertion_type": _ASSERTION,
            "client_assertion": self._key.assertion(platform.client_id, audience),
            "scope": SCORE_SCOPE,
        }
        answer = await self._client.json(platform.token_url, form)
        token, lasts_s = _access(answer)
        self._tokens[platform] = (token, self._clock() + lasts_s - _RENEWED_BEFORE_S)
        return token


def _access(answer: Any) -> tuple[str, float]:
    """Return the token in an answer, and for how many s it is good."""
    values = answer if isinstance(answer, dict) else {}
    lasts_s = values.get("expires_in", 0)
    try:
        token = text(8192)(values.get("access_token"))
        return token, min(float(lasts_s), 86_400.0)
    except (TypeError, ValueError, OverflowError):
        raise PlatformUnreachableError("it provides no access token") from None


def scores_url(line_item: str) -> str:
    """Return where the scores of a line item are sent; its query, as Moodle's has one, stays."""
    parts = urlsplit(line_item)
    return urlunsplit(parts._replace(path=f"{parts.path.rstrip('/')}/scores"))


def _score(grade: DueGrade, utc: str) -> dict[str, Any]:
    return {
        "userId": grade.assignment.subject,
        "scoreGiven": grade.score,
        "scoreMaximum": 100,
        "activityProgress": "Completed",
        "gradingProgress": "FullyGraded",
        "timestamp": utc,
    }


def _after(sent_utc: str | None) -> str:
    """Return the time, or one just after what was sent last: platforms refuse what is older."""
    now = utc_now()
    if sent_utc is None or moment(now) > moment(sent_utc):
        return now
    return (moment(sent_utc) + timedelta(milliseconds=1)).isoformat(timespec="milliseconds")


def _key(grade: DueGrade) -> tuple[str, str, str]:
    assignment = grade.assignment
    return assignment.issuer, assignment.subject, assignment.line_item
