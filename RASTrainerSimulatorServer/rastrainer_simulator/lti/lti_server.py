"""The server that learning platforms and their users' browsers talk to."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import re
import ssl
from collections.abc import Mapping
from typing import Any

from aiohttp import hdrs, web
from aiohttp.typedefs import Handler
from yarl import URL

from rastrainer.errors import InputError
from rastrainer.study.database.database import StudyPlace
from rastrainer_simulator.lti.course_study import CourseStudy, GradeReturn
from rastrainer_simulator.lti.launch_message import (
    LARGEST_TOKEN,
    VALID_S,
    OpenLogins,
    PlatformLaunch,
    RefusedLaunchError,
    new_secret,
    read_launch,
)
from rastrainer_simulator.lti.launch_page import PAGE_HEADERS, LaunchPage
from rastrainer_simulator.lti.platform_client import (
    KeySets,
    PlatformClient,
    PlatformUnreachableError,
)
from rastrainer_simulator.lti.settings import KEYS, LAUNCH, LOGIN, LtiSettings, ToolKey
from rastrainer_simulator.net.limits import ViewLimits
from rastrainer_simulator.net.views.limited_server import LimitedServer
from rastrainer_simulator.ops.study_thread import StudyThread

_log = logging.getLogger(__name__)

COOKIE = "__Host-rastrainer-lti"
COOKIE_TERMS: Mapping[str, Any] = {
    "path": "/",
    "httponly": True,
    "secure": True,
    "samesite": "None",
}
NOT_NOW = "The study or the platform cannot be reached; the program's messages say why."
LARGEST_BODY = 2 * LARGEST_TOKEN
BODY_S = 5.0
LONGEST_HINT = 4096
_SECRET = re.compile(r"[\w-]{43}")


class LtiServer:
    """Serves launches, and returns grades in the background.

    Attributes:
        grades: what returns them.
    """

    def __init__(
        self,
        study: StudyPlace,
        settings: LtiSettings,
        key: ToolKey,
        client: PlatformClient,
        limits: ViewLimits | None = None,
    ) -> None:
        """Serve a study to the platforms of the settings; in the event loop's thread."""
        clock = asyncio.get_running_loop().time
        self._settings, self._key = settings, key
        self._study = StudyThread(lambda: CourseStudy(study))
        self._key_sets = KeySets(client, clock)
        self._logins = OpenLogins(clock)
        routes = [
            web.get(LOGIN, self._login),
            web.post(LOGIN, self._login),
            web.post(LAUNCH, self._launch),
            web.get(KEYS, self._send_keys),
        ]
        self._http = LimitedServer(limits or ViewLimits(), self._check, routes, LARGEST_BODY)
        self.grades = GradeReturn(settings, key, client, self._study, clock)
        self._returning: asyncio.Task[None] | None = None

    async def listen(self, host: str, port: int, tls: ssl.SSLContext | None = None) -> int:
        """Open the study, listen and return the port; 0 is any free one."""
        await self._study.do(CourseStudy.forget_deleted)
        return await self._http.listen(host, port, tls)

    def return_grades(self) -> None:
        """Begin to return grades periodically."""
        self._returning = asyncio.create_task(self.grades.run())

    async def close(self) -> None:
        """Stop the server; grades that are not confirmed are sent after the next start."""
        self._http.stop_listening()
        if self._returning is not None:
            self._returning.cancel()
            await asyncio.gather(self._returning, return_exceptions=True)
        await self._http.close()
        await self._study.close()

    @web.middleware
    async def _check(self, request: web.Request, handler: Handler) -> web.StreamResponse:
        try:
            return await handler(request)
        except RefusedLaunchError as error:
            return _refusal(request, str(error), 400)
        except InputError as error:
            # Paths and addresses of the lab must not be revealed to a visitor.
            _log.warning("A launch has failed: %s", error)
            return _refusal(request, NOT_NOW, 503)

    async def _login(self, request: web.Request) -> web.Response:
        """Send a browser to the platform that wants to launch, to be identified there."""
        values = request.query if request.method == hdrs.METH_GET else await _form(request)
        platform = self._settings.platform(values.get("iss", ""), values.get("client_id", ""))
        if platform is None:
            raise RefusedLaunchError("This platform is not registered here.")
        if values.get("target_link_uri") != self._settings.launch_url:
            raise RefusedLaunchError(f"Links must lead to {self._settings.launch_url}.")
        hints = {
            name: values[name] for name in ("login_hint", "lti_message_hint") if name in values
        }
        if "login_hint" not in hints or any(len(hint) > LONGEST_HINT for hint in hints.values()):
            raise RefusedLaunchError("The platform's login_hint is missing, or a hint is too long.")
        browser = _browser(request) or new_secret()
        state, nonce = self._logins.begin(platform, browser)
        query = {
            "scope": "openid",
            "response_type": "id_token",
            "response_mode": "form_post",
            "prompt": "none",
            "client_id": platform.client_id,
            "redirect_uri": self._settings.launch_url,
            "state": state,
            "nonce": nonce,
            **hints,
        }
        place = URL(platform.authentication_url).update_query(query)
        response = web.Response(status=302, headers={hdrs.LOCATION: str(place), **PAGE_HEADERS})
        # The platform's page posts the launch from another site.
        response.set_cookie(COOKIE, browser, max_age=int(VALID_S), **COOKIE_TERMS)
        return response

    async def _launch(self, request: web.Request) -> web.Response:
        """Show the user who has launched their pseudonym and scores."""
        values = await _form(request)
        login = self._logins.end(values.get("state", ""), _browser(request))
        if "id_token" not in values:
            raise RefusedLaunchError("The platform could not identify you.")
        try:
            launch = await read_launch(
                values["id_token"],
                login.platform,
                login.nonce,
                self._settings.launch_url,
                self._key_sets,
            )
        except PlatformUnreachableError as error:
            raise InputError(f"{login.platform.name} cannot be reached: {error}.") from None
        page = LaunchPage.in_language_of(
            f"{launch.language},{request.headers.get(hdrs.ACCEPT_LANGUAGE, '')}"
        )
        return _html(await self._page(page, launch))

    async def _page(self, page: LaunchPage, launch: PlatformLaunch) -> str:
        if not launch.is_learner:
            return page.for_teacher(launch)
        member = await self._study.do(lambda study: study.member(launch))
        return page.for_learner(launch, member)

    async def _send_keys(self, _request: web.Request) -> web.Response:
        return web.json_response(self._key.key_set())


def _browser(request: web.Request) -> str:
    """Return the secret of a browser; "" if it has none of ours."""
    secret = request.cookies.get(COOKIE, "")
    return secret if _SECRET.fullmatch(secret) else ""


async def _form(request: web.Request) -> Mapping[str, str]:
    """Return the values of a form.

    Raises:
        RefusedLaunchError: there is none.
    """
    if request.content_type == "application/x-www-form-urlencoded":
        # LookupError: an unknown charset.
        with contextlib.suppress(ValueError, LookupError, asyncio.TimeoutError, ConnectionError):
            values = await asyncio.wait_for(request.post(), BODY_S)
            return {name: value for name, value in values.items() if isinstance(value, str)}
    raise RefusedLaunchError("Send a form.")


def _refusal(request: web.Request, reason: str, status: int) -> web.Response:
    page = LaunchPage.in_language_of(request.headers.get(hdrs.ACCEPT_LANGUAGE, ""))
    return _html(page.refusal(reason), status)


def _html(text: str, status: int = 200) -> web.Response:
    return web.Response(text=text, status=status, content_type="text/html", headers=PAGE_HEADERS)
