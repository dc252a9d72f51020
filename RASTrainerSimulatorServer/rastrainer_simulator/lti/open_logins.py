"""Logins that have begun: each belongs to one browser, and is used once."""

from __future__ import annotations

import dataclasses
import hmac
import secrets
from collections.abc import Callable

from rastrainer_simulator.lti.launch_message import RefusedLaunchError
from rastrainer_simulator.lti.settings import LearningPlatform

VALID_S = 600.0
MOST_LOGINS = 4096
_BYTES = 32


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
        """Return the login of a state, which is valid no more.

        Raises:
            RefusedLaunchError: there is none, it is over, or it was begun in another browser.
        """
        login = self._logins.pop(state, None)
        if login is None or login.until < self._clock():
            raise RefusedLaunchError("This launch was used already, or has taken too long.")
        if not hmac.compare_digest(login.browser.encode(), browser.encode()):
            raise RefusedLaunchError(
                "This launch was begun in another browser, or the browser keeps no cookies here: "
                "the course must open the link in a new window."
            )
        return login


def new_secret() -> str:
    """Return an unguessable text."""
    return secrets.token_urlsafe(_BYTES)
