"""The seats of a teacher's board: their list, and pairing, watching and giving them orders.

The teacher's own computer stores addresses and keys. Certificates must be those seen at pairing.
"""

from __future__ import annotations

import asyncio
import hashlib
import re
import ssl
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated
from urllib.parse import urlsplit

import aiohttp
from aiohttp import hdrs

from rastrainer.errors import InputError
from rastrainer.files.reading import printable_name, read_json
from rastrainer.files.writing import write_private_json
from rastrainer.json_checks import decode_message_object, identifier, text, whole_number
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer_simulator.board.board_messages import SeatLink, TileNews
from rastrainer_simulator.net.listener import is_loopback
from rastrainer_simulator.net.views.access_control import LONGEST_KEY, SHORTEST_KEY
from rastrainer_simulator.presentation.messages import (
    SUBPROTOCOL,
    Hello,
    OrderRequest,
    PairingRequest,
    SeatNews,
    ViewRole,
    message_text,
)

SEATS_FILE = "board.json"
FORMAT_VERSION = 1
MOST_SEATS = 64
_MAX_BYTES = 200_000
_FINGERPRINT = re.compile(r"([0-9A-F]{2}:){31}[0-9A-F]{2}")


@dataclass(frozen=True)
class SeatEntry:
    """A simulator that is watched; `fingerprint` is its certificate's SHA-256, "" without TLS."""

    id: Annotated[str, identifier]
    name: Annotated[str, text(40)]
    address: Annotated[str, text(300)]
    key: Annotated[str, text(LONGEST_KEY)]
    fingerprint: Annotated[str, text(200, 0)] = ""


@dataclass(frozen=True)
class SeatsFile:
    """The seats in `board.json`; their addresses and fingerprints are valid."""

    seats: tuple[SeatEntry, ...]
    format_version: Annotated[int, whole_number(FORMAT_VERSION, FORMAT_VERSION)] = FORMAT_VERSION

    def __post_init__(self) -> None:
        if len(self.seats) > MOST_SEATS:
            raise InputError(f"A board has at most {MOST_SEATS} seats.")
        for entry in self.seats:
            if checked_address(entry.address).startswith("https:"):
                checked_fingerprint(entry.fingerprint)


def read_seats(config: Path) -> tuple[SeatEntry, ...]:
    path = config / SEATS_FILE
    if not path.exists():
        return ()
    values = read_json(path, _MAX_BYTES)
    return record_from_json(SeatsFile, values, str(path), only_known=True).seats


def write_seats(config: Path, seats: Iterable[SeatEntry]) -> None:
    """Write a file that only its owner can read."""
    file = record_to_json(SeatsFile(tuple(seats)), with_defaults=True)
    write_private_json(config / SEATS_FILE, file)


def checked_address(address: str) -> str:
    """Return the address of a simulator without what follows the port.

    One that begins with its host is http on this computer, and https elsewhere.
    """
    try:
        parts = urlsplit(address.strip())
        if "://" not in address:
            parts = urlsplit(f"//{address.strip()}")
            parts = parts._replace(scheme="http" if is_loopback(parts.hostname or "") else "https")
        host, port = parts.hostname or "", parts.port
    except ValueError:
        parts, host, port = urlsplit(""), "", None
    if parts.scheme not in ("https", "http") or not host or port is None or parts.username:
        raise InputError(
            f"{printable_name(address)} is not the address of a simulator, which has a host and a "
            "port, as the simulator shows it: such as https://192.0.2.7:18946 with --lan, or "
            "http://127.0.0.1:18945 on this computer."
        )
    if parts.scheme == "http" and not is_loopback(host):
        raise InputError(
            "Only a simulator on this computer is watched without TLS: start the other one with "
            "--lan, and use its https address."
        )
    name = f"[{host}]" if ":" in host else host
    return f"{parts.scheme}://{name}:{port}"


def checked_fingerprint(value: str) -> str:
    """Return a SHA-256 fingerprint as browsers and simulators show it."""
    shown = value.strip().upper()
    if _FINGERPRINT.fullmatch(shown) is None:
        raise InputError("A fingerprint has 32 pairs of hexadecimal digits, separated by colons.")
    return shown


TIMEOUT_S = 8.0
FILE_S = 120.0
"""For a scene, which is some megabytes, over a slow network."""
HEARTBEAT_S = 4.0
"""A simulator that answers no ping for half of this is unreachable."""
MAX_MESSAGE_BYTES = 2**20
MAX_FILE_BYTES = 32 * 2**20
MAX_REASON = 300
AWAY = "The simulator does not answer at {address}."
OTHER_CERTIFICATE = "The certificate has changed: compare its fingerprint again."
UNPAIRED = "The simulator no longer knows this board: pair again."
NOT_OURS = "The server at {address} is not a simulator of this version."


class OtherCertificateError(InputError):
    """The certificate has another fingerprint than the compared one."""


class UnpairedError(InputError):
    """The simulator no longer knows the board's key."""


class RefusedError(InputError):
    """The simulator has refused, for the reason in its answer."""


class SeatClient:
    """Requests to simulators; certificates are checked by fingerprint, not by issuer.

    They raise `OtherCertificateError`, `UnpairedError`, `RefusedError`, or another `InputError`
    where the simulator does not answer.
    """

    def __init__(self) -> None:
        self._session = aiohttp.ClientSession(
            cookie_jar=aiohttp.DummyCookieJar(),
            timeout=aiohttp.ClientTimeout(total=TIMEOUT_S, sock_connect=TIMEOUT_S / 2),
            auto_decompress=False,
        )

    async def __aenter__(self) -> SeatClient:
        return self

    async def __aexit__(self, *_exception: object) -> None:
        await self._session.close()

    async def fingerprint(self, address: str) -> str:
        """Return the fingerprint of the certificate at an https address, to be compared."""
        parts = urlsplit(address)
        place = (parts.hostname or "", parts.port or 0)
        try:
            text = await asyncio.to_thread(ssl.get_server_certificate, place, timeout=TIMEOUT_S)
        except (OSError, ValueError):
            raise InputError(AWAY.format(address=address)) from None
        digest = hashlib.sha256(ssl.PEM_cert_to_DER_cert(text)).digest()
        return digest.hex(":").upper()

    async def pair(self, address: str, fingerprint: str, code: str) -> str:
        entry = SeatEntry("", "", address, "", fingerprint)
        body = PairingRequest(code, ViewRole.BOARD)
        content, _ = await self.request(entry, "/pair", body)
        what = "The answer of the simulator"
        key = decode_message_object(content.decode(errors="replace"), what).get("key")
        if not isinstance(key, str) or not SHORTEST_KEY <= len(key) <= LONGEST_KEY:
            raise InputError(NOT_OURS.format(address=address))
        return key

    async def stream(self, entry: SeatEntry) -> aiohttp.ClientWebSocketResponse:
        try:
            return await self._session.ws_connect(
                f"{entry.address}/stream",
                protocols=(SUBPROTOCOL,),
                heartbeat=HEARTBEAT_S,
                max_msg_size=MAX_MESSAGE_BYTES,
                headers=_headers(entry),
                ssl=_certificate(entry),
            )
        except (aiohttp.ClientError, OSError, asyncio.TimeoutError) as error:
            raise _away(entry, error) from None

    async def request(
        self, entry: SeatEntry, path: str, body: PairingRequest | OrderRequest | None = None
    ) -> tuple[bytes, Mapping[str, str]]:
        """Return content and headers of the answer to a POST, or without a body to a GET."""
        try:
            async with self._session.request(
                hdrs.METH_GET if body is None else hdrs.METH_POST,
                f"{entry.address}{path}",
                json=None if body is None else record_to_json(body, with_defaults=True),
                headers=_headers(entry),
                ssl=_certificate(entry),
                allow_redirects=False,
                timeout=aiohttp.ClientTimeout(
                    total=TIMEOUT_S if body is not None else FILE_S, sock_connect=TIMEOUT_S / 2
                ),
            ) as response:
                content = await _content(response)
        except (aiohttp.ClientError, OSError, asyncio.TimeoutError) as error:
            raise _away(entry, error) from None
        if response.status == 200:
            return content, response.headers
        if response.status in (401, 503):
            raise UnpairedError(UNPAIRED) if response.status == 401 else _away(entry)
        raise RefusedError(content[:MAX_REASON].decode(errors="replace"))


async def _content(response: aiohttp.ClientResponse) -> bytes:
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


def _away(entry: SeatEntry, reason: Exception | None = None) -> InputError:
    """Return what an error says of a simulator."""
    if isinstance(reason, aiohttp.ServerFingerprintMismatch):
        return OtherCertificateError(OTHER_CERTIFICATE)
    if isinstance(reason, aiohttp.WSServerHandshakeError) and reason.status == 401:
        return UnpairedError(UNPAIRED)
    return InputError(AWAY.format(address=entry.address))


RETRY_S = 2.0
_BOARD_HELLO = message_text(Hello("board"))


class WatchedSeat:
    """Watches one simulator in a separate task."""

    def __init__(self, entry: SeatEntry, client: SeatClient, changed: Callable[[], None]) -> None:
        self.entry = entry
        self._client = client
        self._changed = changed
        self._link = SeatLink.CONNECTING
        self._seat: SeatNews | None = None
        self._task = asyncio.create_task(self._watch())

    def tile(self) -> TileNews:
        entry = self.entry
        return TileNews(entry.id, entry.name, entry.address, self._link, self._seat)

    async def close(self) -> None:
        self._task.cancel()
        await asyncio.gather(self._task, return_exceptions=True)

    async def _watch(self) -> None:
        while True:
            link = SeatLink.AWAY
            try:
                await self._receive()
            except UnpairedError:
                link = SeatLink.UNPAIRED
            except OtherCertificateError:
                link = SeatLink.OTHER_CERTIFICATE
            except (InputError, aiohttp.ClientError, OSError):
                pass
            self._become(link)
            await asyncio.sleep(RETRY_S)

    async def _receive(self) -> None:
        stream = await self._client.stream(self.entry)
        try:
            await stream.send_str(_BOARD_HELLO)
            async for message in stream:
                if message.type is not aiohttp.WSMsgType.TEXT:
                    return
                values = decode_message_object(message.data, "The message of a simulator")
                if values.get("type") == SeatNews.type:
                    seat = record_from_json(SeatNews, values, "The seat")
                    self._become(SeatLink.WATCHING, seat)
        finally:
            await stream.close()

    def _become(self, link: SeatLink, seat: SeatNews | None = None) -> None:
        if (link, seat) != (self._link, self._seat):
            self._link, self._seat = link, seat
            self._changed()
