"""The seats of a teacher's board: addresses and keys, kept by the teacher's own computer."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlsplit

from rastrainer.errors import InputError
from rastrainer.files.reading import printable_name, read_json
from rastrainer.files.writing import write_private_json
from rastrainer.json_checks import accepted, text
from rastrainer_simulator.net.listener import is_loopback

SEATS_FILE = "board.json"
FORMAT_VERSION = 1
MOST_SEATS = 64
_MAX_BYTES = 200_000
_FINGERPRINT = re.compile(r"([0-9A-F]{2}:){31}[0-9A-F]{2}")
_ID = re.compile(r"[0-9a-f]{12}")


@dataclasses.dataclass(frozen=True)
class SeatEntry:
    """A simulator that is watched.

    Attributes:
        id: 12 hexadecimal digits, by which the board's page names it.
        name: what the teacher calls it.
        address: "https://HOST:PORT", or "http://" for a simulator on this computer.
        key: that the simulator gave to this board; it only watches.
        fingerprint: SHA-256 of the simulator's certificate, as the simulator shows it; "" without
            TLS.
    """

    id: str
    name: str
    address: str
    key: str
    fingerprint: str = ""


class SeatList:
    """The seats in a file that only its owner can read."""

    def __init__(self, config: Path) -> None:
        """Read the file in the folder of settings; without one there are no seats.

        Raises:
            InputError: the file cannot be read, or is no list of seats.
        """
        self._path = config / SEATS_FILE
        self._entries: dict[str, SeatEntry] = {}
        if self._path.exists():
            self._entries = {entry.id: entry for entry in _read(self._path)}

    def __iter__(self) -> Iterator[SeatEntry]:
        """Return the seats in the order in which they were added."""
        return iter(tuple(self._entries.values()))

    def put(self, entry: SeatEntry) -> None:
        """Add a seat, or replace the one with the same `id`, and keep that.

        Raises:
            InputError: there are too many, or the file cannot be written.
        """
        if entry.id not in self._entries and len(self._entries) >= MOST_SEATS:
            raise InputError(f"A board has at most {MOST_SEATS} seats.")
        self._write({**self._entries, entry.id: entry})

    def remove(self, seat: str) -> None:
        """Forget a seat; one that is not there stays away.

        Raises:
            InputError: the file cannot be written.
        """
        self._write({id_: entry for id_, entry in self._entries.items() if id_ != seat})

    def _write(self, entries: dict[str, SeatEntry]) -> None:
        values = [dataclasses.asdict(entry) for entry in entries.values()]
        write_private_json(self._path, {"formatVersion": FORMAT_VERSION, "seats": values})
        self._entries = entries


def checked_address(address: str) -> str:
    """Return the address of a simulator without what follows the port.

    Raises:
        InputError: it is none, or would send the key over the network in the clear.
    """
    try:
        parts = urlsplit(address.strip())
        host, port = parts.hostname or "", parts.port
    except ValueError:
        parts, host, port = urlsplit(""), "", None
    if parts.scheme not in ("https", "http") or not host or port is None or parts.username:
        raise InputError(
            f"{printable_name(address)} is not the address of a simulator; a simulator that is "
            "started with --lan shows its own, such as https://192.0.2.7:18946."
        )
    if parts.scheme == "http" and not is_loopback(host):
        raise InputError(
            "Only a simulator on this computer is watched without TLS: start the other one with "
            "--lan, and use its https address."
        )
    name = f"[{host}]" if ":" in host else host
    return f"{parts.scheme}://{name}:{port}"


def checked_fingerprint(value: str) -> str:
    """Return a SHA-256 fingerprint as browsers and simulators show it.

    Raises:
        InputError: it is none.
    """
    shown = value.strip().upper()
    if _FINGERPRINT.fullmatch(shown) is None:
        raise InputError("A fingerprint has 32 pairs of hexadecimal digits, separated by colons.")
    return shown


def _read(path: Path) -> list[SeatEntry]:
    values = read_json(path, _MAX_BYTES)
    seats = values.get("seats", []) if isinstance(values, dict) else None
    if not isinstance(seats, list) or len(seats) > MOST_SEATS:
        raise InputError(f"{path} contains no board's seats; move it away to start afresh.")
    return [_entry(path, seat) for seat in seats]


def _entry(path: Path, seat: object) -> SeatEntry:
    names = [field.name for field in dataclasses.fields(SeatEntry)]
    if not isinstance(seat, dict) or set(seat) != set(names):
        raise InputError(f"{path}: a seat must have {', '.join(names)}.")
    checks = {"id": 12, "name": 40, "address": 300, "key": 200}
    found = {
        name: accepted(text(longest), seat[name], f"{path}: {name}")
        for name, longest in checks.items()
    }
    if _ID.fullmatch(found["id"]) is None:
        raise InputError(f"{path}: id must be 12 hexadecimal digits.")
    address = checked_address(found["address"])
    is_safe = address.startswith("https:")
    fingerprint = checked_fingerprint(str(seat["fingerprint"])) if is_safe else ""
    return SeatEntry(found["id"], found["name"], address, found["key"], fingerprint)
