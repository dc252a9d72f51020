"""Who may pass: every request is looked at here before anything else happens."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable

from aiohttp import hdrs, web
from aiohttp.typedefs import Handler

from rastrainer.errors import InputError
from rastrainer.protocol import decode_json_object, text
from rastrainer_simulator.turnstile import Turnstile
from rastrainer_simulator.view_server.origin import check_origin
from rastrainer_simulator.view_server.pairing import DIGITS, TOO_MANY, WRONG, PairingCode
from rastrainer_simulator.view_server.sessions import Sessions

COOKIE = "rastrainer-view"
PAIR_FIRST = "Pair first: POST /pair with the code that the simulator shows."
NOT_A_CODE = f'Send {{"code": "…"}} with the {DIGITS} digits that the simulator shows.'
BODY_S = 5.0
_BEARER = "Bearer "
_code_text = text(64)


class Gate:
    """Lets paired views pass, and everyone else to the page and to the pairing only."""

    def __init__(
        self,
        sessions: Sessions,
        code: PairingCode,
        note: Callable[[web.Request], None],
        note_key: Callable[[web.Request], None],
        turnstile: Turnstile,
    ) -> None:
        """Make a gate.

        Args:
            sessions: whose keys open it.
            code: that a new session is given for.
            note: is told of every request that arrives, and
            note_key: of every one that shows a session's key.
            turnstile: every request waits for its turn at it.
        """
        self._turnstile = turnstile
        self._sessions = sessions
        self._code = code
        self._note = note
        self._note_key = note_key

    @web.middleware
    async def check(self, request: web.Request, handler: Handler) -> web.StreamResponse:
        """Refuse what comes from elsewhere or without a session's key."""
        self._note(request)
        await self._turnstile.passed()
        check_origin(request)
        if self._sessions.knows(_key(request)):
            self._note_key(request)
        elif not _is_public(request):
            raise web.HTTPUnauthorized(text=PAIR_FIRST)
        return await handler(request)

    async def pair(self, request: web.Request) -> web.Response:
        """Give a key, and a cookie with it, for the pairing code."""
        code = await _code(request)
        wait = self._code.seconds_to_wait()
        if wait > 0:
            raise web.HTTPTooManyRequests(
                text=TOO_MANY, headers={hdrs.RETRY_AFTER: str(math.ceil(wait))}
            )
        if not self._code.accepts(code):
            raise web.HTTPForbidden(text=WRONG)
        key = self._sessions.open()
        response = web.json_response({"key": key}, headers={hdrs.CACHE_CONTROL: "no-store"})
        response.set_cookie(
            COOKIE, key, path="/", httponly=True, samesite="Strict", secure=request.secure
        )
        return response


def _is_public(request: web.Request) -> bool:
    resource = request.match_info.route.resource
    return isinstance(resource, web.StaticResource) or (
        resource is not None and resource.canonical in ("/", "/pair")
    )


def _key(request: web.Request) -> str:
    authorization = request.headers.get(hdrs.AUTHORIZATION, "")
    if authorization.startswith(_BEARER):
        return authorization.removeprefix(_BEARER)
    return request.cookies.get(COOKIE, "")


async def _code(request: web.Request) -> str:
    try:
        body = await asyncio.wait_for(request.read(), BODY_S)
        return _code_text(decode_json_object(body.decode()).get("code"))
    except (InputError, ValueError, asyncio.TimeoutError, ConnectionError):
        raise web.HTTPBadRequest(text=NOT_A_CODE) from None
