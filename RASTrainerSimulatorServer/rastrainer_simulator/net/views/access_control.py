"""Access control: checks every request before anything else happens.

A person types the pairing code into a view, and gets a session key for it.
"""

from __future__ import annotations

import asyncio
import hashlib
import hmac
import ipaddress
import logging
import math
import secrets
import socket
from collections import deque
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

from aiohttp import hdrs, web

from rastrainer.errors import InputError
from rastrainer.files.reading import read_json
from rastrainer.files.writing import write_private_json
from rastrainer.json_checks import decode_message_object
from rastrainer.json_records import record_from_json
from rastrainer_simulator.ops.instructor_pin import WRONG_GUESSES, GuessLimit
from rastrainer_simulator.presentation.messages import ViewRole

T = TypeVar("T")
KEY_BYTES = 32
SHORTEST_KEY = 32
LONGEST_KEY = 200
MAX_SESSIONS = 64
"""Keys of each role that are remembered; then the oldest is forgotten."""
BOARDS_FILE = "boards.json"
_MAX_BYTES = 100_000
_HASH_DIGITS = 64
DIGITS = 6
WRONG = "This is not the pairing code that the simulator shows."
TOO_MANY = "There were too many wrong codes: wait, then use the new code that the simulator shows."
_log = logging.getLogger(__name__)


class Sessions:
    """The keys that were given out, by their hashes."""

    def __init__(self, boards: Path | None = None) -> None:
        """Keep the keys of boards also in the file `boards`; deleting it unpairs all boards."""
        self._hashes = {role: deque[bytes](maxlen=MAX_SESSIONS) for role in ViewRole}
        self._boards = boards
        if boards is None or not boards.exists():
            return
        found = read_json(boards, _MAX_BYTES)
        try:
            if any(len(each) != _HASH_DIGITS for each in found):
                raise ValueError
            self._hashes[ViewRole.BOARD].extend(bytes.fromhex(each) for each in found)
        except (TypeError, ValueError):
            raise InputError(
                f"{boards} does not hold the hashes of boards' keys; delete it, and pair boards "
                "again."
            ) from None

    def open(self, role: ViewRole = ViewRole.VIEW) -> str:
        key = secrets.token_urlsafe(KEY_BYTES)
        self._hashes[role].append(_hash(key))
        if role is ViewRole.BOARD and self._boards is not None:
            write_private_json(self._boards, [each.hex() for each in self._hashes[role]])
        return key

    def role(self, key: str) -> ViewRole | None:
        """Return what a key was given out for, None for no key; it takes the same time for all."""
        if not SHORTEST_KEY <= len(key) <= LONGEST_KEY:
            return None
        wanted = _hash(key)
        found = None
        for role, hashes in self._hashes.items():
            matches = [hmac.compare_digest(wanted, known) for known in hashes]
            if any(matches):
                found = role
        return found


def _hash(key: str) -> bytes:
    return hashlib.sha256(key.encode(errors="replace")).digest()


class PairingCode(GuessLimit):
    """The present code. After five wrong codes it changes, and a growing pause begins."""

    def __init__(self, clock: Callable[[], float], on_new: Callable[[str], None]) -> None:
        """Make a code; `on_new` is given each one after it, to be shown."""
        super().__init__(clock)
        self._on_new = on_new
        self.code = _new_code()
        """Digits that a person types; never logged."""

    def accepts(self, code: str) -> bool:
        """Compare a code, in the same time for every code, and count wrong codes."""
        is_right = hmac.compare_digest(code.encode(), self.code.encode())
        if self.guessed(is_right):
            _log.warning("%d wrong pairing codes were tried; there is a new one.", WRONG_GUESSES)
            self.code = _new_code()
            self._on_new(self.code)
        return is_right


def _new_code() -> str:
    return f"{secrets.randbelow(10**DIGITS):0{DIGITS}d}"


COOKIE = "rastrainer-view"
PAIR_FIRST = "Pair first: POST /pair with the code that the simulator shows."
BODY_S = 5.0
BEARER = "Bearer "
ROLE = web.RequestKey("role", ViewRole)
"""Where a request that has passed has the role of its key."""
WRONG_HOST = "The simulator is not known under this name: use its address."
FOREIGN = "A page of another origin may not connect."
HEADERS = {
    "Content-Security-Policy": (
        "default-src 'self'; img-src 'self' blob: data:; connect-src 'self' blob:; "
        "worker-src 'self' blob:; object-src 'none'; base-uri 'none'; form-action 'self'; "
        "frame-ancestors 'none'"
    ),
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Permissions-Policy": "xr-spatial-tracking=(self), gamepad=(self), camera=(), microphone=()",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
}


def refuse_for(wait_s: float, why: str) -> None:
    """Raise `web.HTTPTooManyRequests` with a sentence where there are seconds to wait."""
    if wait_s > 0:
        headers = {hdrs.RETRY_AFTER: str(math.ceil(wait_s))}
        raise web.HTTPTooManyRequests(text=why, headers=headers)


def is_public(request: web.Request) -> bool:
    """Return whether a request needs no key: for the page, its files, or pairing."""
    resource = request.match_info.route.resource
    return isinstance(resource, web.StaticResource) or (
        resource is not None and resource.canonical in ("/", "/pair")
    )


async def read_body(request: web.Request, kind: type[T]) -> T:
    """Return the record of a request's body, which must arrive within `BODY_S`."""
    try:
        body = (await asyncio.wait_for(request.read(), BODY_S)).decode()
        return record_from_json(kind, decode_message_object(body, "The body"), "The body")
    except InputError as error:
        raise web.HTTPBadRequest(text=str(error)) from None
    except (ValueError, asyncio.TimeoutError, ConnectionError):
        raise web.HTTPBadRequest(text="Send one JSON object.") from None


def check_origin(request: web.Request) -> None:
    """Raise `web.HTTPForbidden` unless a request is for us and, of a browser, from our own page.

    A name that another name server points here (DNS rebinding) is not ours.
    """
    name, colon, port = request.host.rpartition(":")
    bare = (name if colon and port.isdecimal() else request.host).strip("[]")
    own = socket.gethostname().lower().removesuffix(".local")
    try:
        ipaddress.ip_address(bare)
    except ValueError:
        if bare.lower() not in ("localhost", own, f"{own}.local"):
            raise web.HTTPForbidden(text=WRONG_HOST) from None
    origin = request.headers.get("Origin")
    if origin is not None and origin != f"{request.scheme}://{request.host}":
        raise web.HTTPForbidden(text=FOREIGN)


def fresh_json(values: Mapping[str, Any]) -> web.Response:
    return web.json_response(values, headers={hdrs.CACHE_CONTROL: "no-store"})


async def open_socket(
    request: web.Request, subprotocol: str, **settings: Any
) -> web.WebSocketResponse:
    """Return a WebSocket of a protocol, opened with aiohttp's settings.

    Every message waits until the previous one has left: only then is the latest sent.
    """
    stream = web.WebSocketResponse(protocols=(subprotocol,), writer_limit=0, **settings)
    if stream.can_prepare(request).protocol != subprotocol:
        raise web.HTTPBadRequest(text=f"Ask for a WebSocket with {subprotocol}.")
    await stream.prepare(request)
    return stream


async def add_security_headers(_request: web.Request, response: web.StreamResponse) -> None:
    for name, value in HEADERS.items():
        response.headers.setdefault(name, value)
    response.headers.setdefault("Cache-Control", "no-cache")
    response.headers.pop("Server", None)
