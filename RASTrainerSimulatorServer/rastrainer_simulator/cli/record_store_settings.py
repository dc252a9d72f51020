"""What is the same each time statements are made: the record store, and the lab's own address."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from rastrainer.files.json_fields import known_keys
from rastrainer.files.reading import printable_name, read_json
from rastrainer.json_checks import Argument, text
from rastrainer_simulator.ops.folders import config_folder

RECORD_STORE_FILE = "record-store.json"
_MAX_BYTES = 10_000


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


@dataclasses.dataclass(frozen=True)
class RecordStoreSettings:
    """What the file says; "" or None where it says nothing.

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
    """Return the settings in a folder, by default the usual one; without a file there are none.

    Raises:
        InputError: the file cannot be used.
    """
    folder = config or config_folder()
    path = folder / RECORD_STORE_FILE
    if not path.exists():
        return RecordStoreSettings()
    values = read_json(path, _MAX_BYTES)
    checked = known_keys(values, _KEYS, printable_name(path))
    credentials = folder / checked["credentials"] if checked["credentials"] else None
    return RecordStoreSettings(checked["store"], checked["homePage"], credentials)
