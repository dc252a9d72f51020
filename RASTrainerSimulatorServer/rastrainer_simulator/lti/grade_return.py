"""Grades to learning platforms (Assignment and Grade Services), each until it is confirmed."""

from __future__ import annotations

import asyncio
import json
import logging
from collections import Counter
from collections.abc import Callable
from datetime import timedelta
from typing import Any
from urllib.parse import urlsplit, urlunsplit

from rastrainer.errors import InputError
from rastrainer.json_checks import text
from rastrainer.study.database.values import moment, utc_now
from rastrainer_simulator.lti.course_study import CourseStudy, DueGrade
from rastrainer_simulator.lti.launch_message import SCORE_SCOPE
from rastrainer_simulator.lti.platform_client import PlatformClient, PlatformUnreachableError
from rastrainer_simulator.lti.settings import LearningPlatform, LtiSettings, ToolKey
from rastrainer_simulator.ops.study_thread import StudyThread

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
                # Launches go on, and nobody would notice that nothing is sent any more.
                _log.exception("Grades wait because of an unexpected error")
            await asyncio.sleep(ROUND_S)

    async def send_due(self) -> int:
        """Send once what is due and return how many grades were confirmed.

        Raises:
            InputError: the study or its links cannot be used.
        """
        confirmed = 0
        due = await self._study.do(CourseStudy.due)
        # A grade that a platform always fails at comes last, and so holds up no other.
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
        """Send a grade and return whether it was taken; one that is refused holds up no other."""
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
