"""A launch by a learning platform: the login that begins it, and the checked message that ends it.

The message says which of a trainee's trials makes the grade in the course. A login belongs to one
browser, and is used once.
"""

from __future__ import annotations

import dataclasses
import hmac
import secrets
import time
from collections.abc import Callable, Iterable, Mapping
from enum import Enum
from typing import Any

import jwt

from rastrainer.errors import InputError
from rastrainer.json_checks import text
from rastrainer.protocol import RegistrationMethod
from rastrainer.study.platform_links import LinkedAssignment
from rastrainer.trial.trial_feedback import PastTrial
from rastrainer_simulator.lti.platform_client import KeySets
from rastrainer_simulator.lti.settings import ALGORITHM, LearningPlatform


class GradeRule(str, Enum):
    """Which acceptable trial counts."""

    BEST = "best"
    LATEST = "latest"


@dataclasses.dataclass(frozen=True)
class GradeTerms:
    """What a link of a course asks for.

    Attributes:
        task, mode: Of the trials that count; "" for any.
        method: Of their registration: scores of different methods are not compared.
        rule: Which of them counts.
    """

    task: str
    mode: str
    method: RegistrationMethod
    rule: GradeRule

    @classmethod
    def of(cls, stored: LinkedAssignment) -> GradeTerms:
        method, rule = RegistrationMethod(stored.method), GradeRule(stored.rule)
        return cls(stored.task, stored.mode, method, rule)

    def grade(self, trials: Iterable[PastTrial]) -> float | None:
        """Return the score of the trial that counts, 0 to 100; None without an acceptable one.

        A trial that is not acceptable gives no grade: its registration would have misled an
        instrument.

        Args:
            trials: Scored ones of one trainee, in order of starting.
        """
        scores = [
            trial.score
            for trial in trials
            if trial.acceptable
            and trial.method is self.method
            and self.task in ("", trial.task)
            and self.mode in ("", trial.mode)
        ]
        if not scores:
            return None
        return max(scores) if self.rule is GradeRule.BEST else scores[-1]


VALID_S = 600.0
"""Of a login."""
MOST_LOGINS = 4096
_SECRET_BYTES = 32
LARGEST_TOKEN = 16_384
LEEWAY_S = 60
OLDEST_S = 600
"""Of a token; a launch takes seconds."""
_CLAIM = "https://purl.imsglobal.org/spec/lti/claim/"
_GRADES = "https://purl.imsglobal.org/spec/lti-ags/claim/endpoint"
SCORE_SCOPE = "https://purl.imsglobal.org/spec/lti-ags/scope/score"
_LEARNER = "http://purl.imsglobal.org/vocab/lis/v2/membership"
MODES = ("desktop", "hmd")


class RefusedLaunchError(InputError):
    """The message is not one that this tool may accept."""


@dataclasses.dataclass(frozen=True)
class OpenLogin:
    """A login that waits for the platform's message.

    Attributes:
        platform: That is asked.
        browser: Secret of the browser that began it.
        nonce: That the message must repeat.
        until: Time in s until which it is valid.
    """

    platform: LearningPlatform
    browser: str
    nonce: str
    until: float


class OpenLogins:
    """The logins by their states; the oldest is forgotten where there are too many."""

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._logins: dict[str, OpenLogin] = {}

    def begin(self, platform: LearningPlatform, browser: str) -> tuple[str, str]:
        """Return state and nonce of a new login in a browser with this secret."""
        if len(self._logins) >= MOST_LOGINS:
            del self._logins[next(iter(self._logins))]
        state, nonce = new_secret(), new_secret()
        self._logins[state] = OpenLogin(platform, browser, nonce, self._clock() + VALID_S)
        return state, nonce

    def end(self, state: str, browser: str) -> OpenLogin:
        """Return the login of a state, which can be used only once.

        Raises:
            RefusedLaunchError: there is none, it has expired, or it was begun in another browser.
        """
        login = self._logins.pop(state, None)
        if login is None or login.until < self._clock():
            raise RefusedLaunchError("This launch was used already, or has taken too long.")
        if not hmac.compare_digest(login.browser.encode(), browser.encode()):
            raise RefusedLaunchError(
                "This launch was begun in another browser, or this browser keeps no cookies: "
                "the course must open the link in a new window."
            )
        return login


def new_secret() -> str:
    """Return an unguessable text."""
    return secrets.token_urlsafe(_SECRET_BYTES)


@dataclasses.dataclass(frozen=True)
class PlatformLaunch:
    """A launch that the platform has signed.

    Attributes:
        platform: That sent it.
        subject: The user, as the platform knows them.
        is_learner: Whether they learn in this course.
        terms: What of theirs counts.
        line_item: Address of the column in the gradebook; "" where no grade is wanted.
        language: That the platform names, such as "de-DE"; "" if none.
    """

    platform: LearningPlatform
    subject: str
    is_learner: bool
    terms: GradeTerms
    line_item: str
    language: str


async def read_launch(
    token: str, platform: LearningPlatform, nonce: str, launch_url: str, key_sets: KeySets
) -> PlatformLaunch:
    """Return the launch in an `id_token`.

    Nothing in the token says where to fetch its key.

    Args:
        token: As it was posted.
        platform: That the login was for.
        nonce: Of this login.
        launch_url: This tool's.
        key_sets: Has the platform's keys.

    Raises:
        RefusedLaunchError: it is forged, for others, too old, or not what was asked for.
        PlatformUnreachableError: the platform's keys cannot be fetched.
    """
    key = await key_sets.key(platform.key_set_url, _key_id(token))
    if key is None:
        raise RefusedLaunchError("The platform has no key with the ID in the token.")
    try:
        claims = jwt.decode(
            token,
            key,
            algorithms=[ALGORITHM],
            audience=platform.client_id,
            issuer=platform.issuer,
            leeway=LEEWAY_S,
            options={"require": ["exp", "iat", "iss", "aud", "nonce"]},
        )
    except (jwt.PyJWTError, ValueError, TypeError, RecursionError, OverflowError) as error:
        raise RefusedLaunchError(f"The token is not valid: {error}.") from None
    _check_recipient(claims, platform)
    _check_message(claims, platform, nonce, launch_url)
    return _launch(claims, platform)


def _key_id(token: str) -> str:
    if len(token) > LARGEST_TOKEN:
        raise RefusedLaunchError(f"The token has more than {LARGEST_TOKEN} characters.")
    try:
        header = jwt.get_unverified_header(token)
    except (jwt.PyJWTError, ValueError, RecursionError):
        raise RefusedLaunchError("This is not a token.") from None
    if header.get("alg") != ALGORITHM:
        raise RefusedLaunchError(f"The token must be signed by {ALGORITHM}.")
    return _short(header.get("kid"), "The key ID of the token")


def _check_recipient(claims: Mapping[str, Any], platform: LearningPlatform) -> None:
    """Refuse a token that is also, or actually, for another tool, and one that is old."""
    if claims["aud"] not in (platform.client_id, [platform.client_id]):
        raise RefusedLaunchError("The token is also addressed to other tools.")
    if claims.get("azp", platform.client_id) != platform.client_id:
        raise RefusedLaunchError("The token was issued to another tool.")
    if int(claims["iat"]) < time.time() - OLDEST_S - LEEWAY_S:
        raise RefusedLaunchError("The token is too old.")


def _check_message(
    claims: Mapping[str, Any], platform: LearningPlatform, nonce: str, launch_url: str
) -> None:
    """Refuse a message other than the launch that was asked for."""
    wanted = {
        "nonce": nonce,
        f"{_CLAIM}version": "1.3.0",
        f"{_CLAIM}message_type": "LtiResourceLinkRequest",
        f"{_CLAIM}target_link_uri": launch_url,
    }
    for name, value in wanted.items():
        if claims.get(name) != value:
            raise RefusedLaunchError(
                f"The token's {name.removeprefix(_CLAIM)} is not the expected one."
            )
    if claims.get(f"{_CLAIM}deployment_id") not in platform.deployment_ids:
        raise RefusedLaunchError("The platform launches from a deployment that is not registered.")
    _short(_object(claims, f"{_CLAIM}resource_link").get("id"), "The ID of the link")


def _launch(claims: Mapping[str, Any], platform: LearningPlatform) -> PlatformLaunch:
    roles = claims.get(f"{_CLAIM}roles")
    presentation = _object(claims, f"{_CLAIM}launch_presentation")
    return PlatformLaunch(
        platform=platform,
        subject=_short(claims.get("sub"), "Who launches (sub)"),
        is_learner=isinstance(roles, list) and any(map(_is_learner, roles)),
        terms=_terms(_object(claims, f"{_CLAIM}custom")),
        line_item=_line_item(_object(claims, _GRADES), platform),
        language=str(presentation.get("locale", ""))[:20],
    )


def _is_learner(role: object) -> bool:
    name = str(role)
    return name in ("Learner", f"{_LEARNER}#Learner") or name.startswith(f"{_LEARNER}/Learner#")


def _terms(custom: Mapping[str, Any]) -> GradeTerms:
    """Return what the link of the course says; anything misspelled there is reported at once."""
    rules = [rule.value for rule in GradeRule]
    methods = [method.value for method in RegistrationMethod]
    chosen = {
        "mode": (custom.get("mode", ""), ("", *MODES)),
        "rule": (custom.get("rule", GradeRule.BEST.value), rules),
        "method": (custom.get("method", RegistrationMethod.FIDUCIALS.value), methods),
    }
    for name, (value, choices) in chosen.items():
        if value not in choices:
            words = ", ".join(choice for choice in choices if choice)
            raise RefusedLaunchError(f"The link's custom parameter {name} must be one of {words}.")
    task = custom.get("task", "")
    return GradeTerms(
        task=_short(task, "The link's custom parameter task") if task else "",
        mode=chosen["mode"][0],
        method=RegistrationMethod(chosen["method"][0]),
        rule=GradeRule(chosen["rule"][0]),
    )


def _line_item(endpoint: Mapping[str, Any], platform: LearningPlatform) -> str:
    address, scopes = endpoint.get("lineitem"), endpoint.get("scope")
    may_send = isinstance(scopes, list) and SCORE_SCOPE in scopes and platform.sends_grades
    if not isinstance(address, str) or not may_send:
        return ""
    if not platform.takes_grades_at(address):
        raise RefusedLaunchError(
            "The gradebook's address is on another server than the platform's; if it is right, "
            "the lab adds it to lineItemOrigins in its settings."
        )
    return address


def _object(claims: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    value = claims.get(name)
    return value if isinstance(value, dict) else {}


def _short(value: object, what: str) -> str:
    try:
        return text(255)(value)
    except ValueError as error:
        raise RefusedLaunchError(f"{what} must be {error}.") from None
