"""A learning record store for xAPI statements (IEEE 9274.1.1, xAPI 1.0.3): settings, requests."""

from __future__ import annotations

import base64
import http.client
import json
import ssl
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from rastrainer.errors import InputError
from rastrainer.files.json_fields import known_keys
from rastrainer.files.reading import printable_name, read_json
from rastrainer.json_checks import Argument, text
from rastrainer_simulator.net.listener import is_loopback
from rastrainer_simulator.ops.system_paths import config_folder

XAPI_VERSION = "1.0.3"
TIMEOUT_S = 20.0
MAX_ANSWER_BYTES = 1_000_000
MAX_REASON = 200
BATCH = 50
"""Statements in one request: small enough for every store's limit."""
_STORED, _KNOWN, _DIFFERS = 200, 204, 409
_BUSY = (408, 429)
_CLOSED = (401, 403)


class StoreUnreachableError(InputError):
    """The store does not answer, or asks for patience: the same statements may be sent later."""


@dataclass
class Delivery:
    """The outcome of statements, by their UUIDs.

    Attributes:
        stored: that the store has, from now or from earlier.
        differing: of which the store has another version, which it keeps.
        refused: with the store's reason.
    """

    stored: list[str] = field(default_factory=list)
    differing: list[str] = field(default_factory=list)
    refused: dict[str, str] = field(default_factory=dict)


class RecordStore:
    """One store; each request has its own connection, and no redirection is followed."""

    def __init__(self, url: str, credentials: str) -> None:
        """Check the address.

        Args:
            url: of the xAPI endpoint, such as "https://lrs.example.org/xAPI"; only this computer
                may be addressed without TLS.
            credentials: name and password as "name:password".
        """
        try:
            parts = urlsplit(url)
            self._host, self._port = parts.hostname or "", parts.port
        except ValueError:
            raise InputError(
                f"{printable_name(url)} has a host that is none, or a port that is no number."
            ) from None
        self._is_safe = parts.scheme == "https"
        if parts.scheme not in ("https", "http") or not self._host or parts.query or parts.username:
            raise InputError(
                f"{printable_name(url)} is no address of a record store; give one such as "
                "https://lrs.example.org/xAPI, without a name or password in it."
            )
        if not self._is_safe and not is_loopback(self._host):
            raise InputError(
                "Pseudonyms and the password would be sent in the clear: "
                f"the address must begin with https://, not {printable_name(url)}."
            )
        name, colon, password = credentials.partition(":")
        if not (name and colon and password) or not credentials.isprintable():
            raise InputError("The credentials must be name:password.")
        self._path = f"{parts.path.rstrip('/')}/statements"
        token = base64.b64encode(credentials.encode()).decode()
        self._headers = {
            "Authorization": f"Basic {token}",
            "Content-Type": "application/json",
            "X-Experience-API-Version": XAPI_VERSION,
        }

    def deliver(self, statements: Sequence[dict[str, Any]]) -> Delivery:
        """Send up to `BATCH` statements; one that is refused does not delay the others.

        Raises:
            StoreUnreachableError: the store is not reached; it may have taken some of them.
            InputError: it refuses the credentials, or is no record store.
        """
        delivery = Delivery()
        self._deliver(statements, delivery)
        return delivery

    def _deliver(self, statements: Sequence[dict[str, Any]], delivery: Delivery) -> None:
        status, answer = self._post(statements)
        ids = [statement["id"] for statement in statements]
        if status in (_STORED, _KNOWN):
            delivery.stored += ids
        elif len(statements) > 1:
            # A store takes all statements of a request or none: find the one that it refuses.
            half = len(statements) // 2
            self._deliver(statements[:half], delivery)
            self._deliver(statements[half:], delivery)
        elif status == _DIFFERS:
            delivery.differing += ids
        else:
            delivery.refused[ids[0]] = f"status {status}, {printable_name(answer[:MAX_REASON])}"

    def _post(self, statements: Sequence[dict[str, Any]]) -> tuple[int, str]:
        connection = self._connection()
        try:
            body = json.dumps(list(statements), allow_nan=False).encode()
            connection.request("POST", self._path, body, self._headers)
            response = connection.getresponse()
            answer = response.read(MAX_ANSWER_BYTES).decode("utf-8", "replace")
        except ssl.SSLCertVerificationError as error:
            raise InputError(
                f"The record store cannot be trusted: {error.verify_message}."
            ) from None
        except (OSError, http.client.HTTPException) as error:
            reason = getattr(error, "strerror", None) or str(error) or type(error).__name__
            raise StoreUnreachableError(f"The record store does not answer: {reason}.") from None
        finally:
            connection.close()
        if response.status in _CLOSED:
            raise InputError(
                f"The record store does not accept the credentials (status {response.status})."
            )
        if response.status in _BUSY or response.status >= 500:
            raise StoreUnreachableError(f"The record store is busy (status {response.status}).")
        if response.status == 404 or 300 <= response.status < 400:
            raise InputError(
                f"There is no record store at this address (status {response.status}); "
                "give that of its xAPI endpoint, such as https://lrs.example.org/xAPI."
            )
        return response.status, answer

    def _connection(self) -> http.client.HTTPConnection:
        if self._is_safe:
            return http.client.HTTPSConnection(self._host, self._port, timeout=TIMEOUT_S)
        return http.client.HTTPConnection(self._host, self._port, timeout=TIMEOUT_S)


RECORD_STORE_FILE = "record-store.json"
_MAX_FILE_BYTES = 10_000


def home_page_url(value: Any) -> str:
    """Accept the address of a lab's own system, from which IRIs are made."""
    address = text(300, min_length=0)(value)
    if not _is_home_page(address):
        raise ValueError("the address of the lab's own system, such as https://lab.example.org")
    return address.rstrip("/")


def _is_home_page(address: str) -> bool:
    # What stands before an "@", such as a password, would be sent with every statement.
    if any(sign in address for sign in "@?# "):
        return False
    try:
        parts = urlsplit(address)
        host, _port = parts.hostname or "", parts.port
    except ValueError:
        return False
    return parts.scheme in ("https", "http") and host != "" and not host.endswith(".invalid")


@dataclass(frozen=True)
class RecordStoreSettings:
    """The settings in the file; "" or None if missing.

    Attributes:
        store: URL of the xAPI endpoint.
        home_page: Of the lab's own system, from which the IRIs of statements are made.
        credentials: File with name:password of the store.
    """

    store: str = ""
    home_page: str = ""
    credentials: Path | None = None


_KEYS = {
    "store": Argument(text(500), ""),
    "homePage": Argument(home_page_url, ""),
    "credentials": Argument(text(1000), ""),
}


def read_record_store_settings(config: Path | None) -> RecordStoreSettings:
    """Return the settings in a folder, by default the usual one; without a file there are none."""
    folder = config or config_folder()
    path = folder / RECORD_STORE_FILE
    if not path.exists():
        return RecordStoreSettings()
    values = read_json(path, _MAX_FILE_BYTES)
    checked = known_keys(values, _KEYS, printable_name(path))
    credentials = folder / checked["credentials"] if checked["credentials"] else None
    return RecordStoreSettings(checked["store"], checked["homePage"], credentials)
