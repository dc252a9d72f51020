"""Talk to simulators as a board: pair, watch, give orders; certificates are those of before."""

from __future__ import annotations

import asyncio
import hashlib
import ssl
from types import TracebackType
from typing import Any
from urllib.parse import urlsplit

import aiohttp
from aiohttp import hdrs

from rastrainer.errors import InputError
from rastrainer.json_checks import decode_message_object
from rastrainer_simulator.board.seat_list import SeatEntry
from rastrainer_simulator.net.views.messages import SUBPROTOCOL
from rastrainer_simulator.net.views.presenter import InstructorOrder
from rastrainer_simulator.net.views.sessions import LONGEST_KEY, SHORTEST_KEY, ViewRole

TIMEOUT_S = 8.0
FILE_S = 120.0
"""For a scene, which is some megabytes, over a slow network."""
HEARTBEAT_S = 4.0
"""A simulator that answers no ping for half of this is away."""
MAX_MESSAGE_BYTES = 2**20
MAX_FILE_BYTES = 32 * 2**20
MAX_REASON = 300
AWAY = "The simulator does not answer at {address}."
OTHER_CERTIFICATE = "The certificate has changed: compare its fingerprint again."
NOT_OURS = "The server at {address} is not a simulator of this version."


class SeatUnreachableError(InputError):
    """The simulator does not answer."""


class OtherCertificateError(InputError):
    """The certificate is not the one whose fingerprint was compared."""


class UnpairedError(InputError):
    """The simulator does not know the board's key any more."""


class RefusedError(InputError):
    """The simulator has refused; `wait_s` is how long it refuses everything, 0 for no time."""

    def __init__(self, sentence: str, wait_s: int = 0) -> None:
        super().__init__(sentence)
        self.wait_s = wait_s


class SeatClient:
    """Requests to simulators; certificates are checked by their fingerprints, not by who signed."""

    def __init__(self) -> None:
        """Open nothing yet; in the event loop's thread."""
        self._session = aiohttp.ClientSession(
            cookie_jar=aiohttp.DummyCookieJar(),
            timeout=aiohttp.ClientTimeout(total=TIMEOUT_S, sock_connect=TIMEOUT_S / 2),
            auto_decompress=False,
        )

    async def __aenter__(self) -> SeatClient:
        """Return itself."""
        return self

    async def __aexit__(
        self,
        _kind: type[BaseException] | None,
        _error: BaseException | None,
        _traceback: TracebackType | None,
    ) -> None:
        """Close all connections."""
        await self._session.close()

    async def fingerprint(self, address: str) -> str:
        """Return the fingerprint of the certificate at an https address, to be compared.

        Raises:
            SeatUnreachableError: nobody answers by TLS.
        """
        parts = urlsplit(address)
        place = (parts.hostname or "", parts.port or 0)
        try:
            text = await asyncio.to_thread(ssl.get_server_certificate, place, timeout=TIMEOUT_S)
        except (OSError, ValueError):
            raise SeatUnreachableError(AWAY.format(address=address)) from None
        digest = hashlib.sha256(ssl.PEM_cert_to_DER_cert(text)).digest()
        return digest.hex(":").upper()

    async def pair(self, address: str, fingerprint: str, code: str) -> str:
        """Return a key for a pairing code.

        Raises:
            RefusedError: the code is wrong.
            SeatUnreachableError, OtherCertificateError, UnpairedError: as their names say.
            InputError: something else answers.
        """
        entry = SeatEntry("", "", address, "", fingerprint)
        body = {"code": code, "role": ViewRole.BOARD.value}
        answer = decode_message_object(
            (await self._request(entry, hdrs.METH_POST, "/pair", body)).decode(errors="replace"),
            "The answer of the simulator",
        )
        key = answer.get("key")
        if not isinstance(key, str) or not SHORTEST_KEY <= len(key) <= LONGEST_KEY:
            raise InputError(NOT_OURS.format(address=address))
        return key

    async def order(self, entry: SeatEntry, order: InstructorOrder, text: str, pin: str) -> None:
        """Have something done at a seat.

        Raises:
            RefusedError: the PIN is wrong, or it cannot be done now.
            SeatUnreachableError, OtherCertificateError, UnpairedError: as their names say.
        """
        body = {"pin": pin, "order": order.value, "text": text}
        await self._request(entry, hdrs.METH_POST, "/instructor", body)

    async def file(self, entry: SeatEntry, path: str) -> tuple[bytes, dict[str, str]]:
        """Return a file of a simulator, and those of its headers that a page needs.

        Raises:
            RefusedError: there is none.
            SeatUnreachableError, OtherCertificateError, UnpairedError: as their names say.
        """
        headers: dict[str, str] = {}
        content = await self._request(entry, hdrs.METH_GET, path, None, headers)
        return content, headers

    async def stream(self, entry: SeatEntry) -> aiohttp.ClientWebSocketResponse:
        """Open the stream of a simulator; the hello is to be sent.

        Raises:
            SeatUnreachableError, OtherCertificateError, UnpairedError: as their names say.
        """
        try:
            return await self._session.ws_connect(
                f"{entry.address}/stream",
                protocols=(SUBPROTOCOL,),
                heartbeat=HEARTBEAT_S,
                max_msg_size=MAX_MESSAGE_BYTES,
                headers=_headers(entry),
                ssl=_certificate(entry),
            )
        except aiohttp.WSServerHandshakeError as error:
            raise _problem(entry, error.status) from None
        except aiohttp.ServerFingerprintMismatch:
            raise OtherCertificateError(OTHER_CERTIFICATE) from None
        except (aiohttp.ClientError, OSError, asyncio.TimeoutError):
            raise SeatUnreachableError(AWAY.format(address=entry.address)) from None

    async def _request(
        self,
        entry: SeatEntry,
        method: str,
        path: str,
        body: dict[str, Any] | None,
        headers: dict[str, str] | None = None,
    ) -> bytes:
        try:
            async with self._session.request(
                method,
                f"{entry.address}{path}",
                json=body,
                headers=_headers(entry),
                ssl=_certificate(entry),
                allow_redirects=False,
                timeout=aiohttp.ClientTimeout(
                    total=TIMEOUT_S if body is not None else FILE_S, sock_connect=TIMEOUT_S / 2
                ),
            ) as response:
                content = await _content(response)
        except aiohttp.ServerFingerprintMismatch:
            raise OtherCertificateError(OTHER_CERTIFICATE) from None
        except (aiohttp.ClientError, OSError, asyncio.TimeoutError):
            raise SeatUnreachableError(AWAY.format(address=entry.address)) from None
        if response.status == 200:
            if headers is not None:
                headers.update(response.headers)
            return content
        if response.status in (401, 503):
            raise _problem(entry, response.status)
        reason = content[:MAX_REASON].decode(errors="replace")
        wait = response.headers.get(hdrs.RETRY_AFTER, "0")
        raise RefusedError(reason, int(wait) if wait.isdecimal() and len(wait) < 6 else 0)


async def _content(response: aiohttp.ClientResponse) -> bytes:
    """Return an answer that is not larger than the largest file."""
    pieces = bytearray()
    async for piece in response.content.iter_chunked(2**16):
        pieces += piece
        if len(pieces) > MAX_FILE_BYTES:
            raise aiohttp.ClientPayloadError
    return bytes(pieces)


def _headers(entry: SeatEntry) -> dict[str, str]:
    headers: dict[str, str] = {hdrs.ACCEPT_ENCODING: "gzip"}
    if entry.key:
        headers[hdrs.AUTHORIZATION] = f"Bearer {entry.key}"
    return headers


def _certificate(entry: SeatEntry) -> aiohttp.Fingerprint | bool:
    if not entry.fingerprint:
        return True
    return aiohttp.Fingerprint(bytes.fromhex(entry.fingerprint.replace(":", "")))


def _problem(entry: SeatEntry, status: int) -> InputError:
    if status == 401:
        return UnpairedError("The simulator does not know this board any more: pair again.")
    return SeatUnreachableError(AWAY.format(address=entry.address))
