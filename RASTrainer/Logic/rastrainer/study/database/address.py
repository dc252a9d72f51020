"""Where a study is: the path of an SQLite file, or the address of a database in PostgreSQL.

An address never holds a password: libpq finds it in the user's own `~/.pgpass`, or in PGPASSFILE or
PGPASSWORD. So none gets into settings, histories of shells, lists of processes or sentences.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import parse_qsl, quote, unquote, urlencode, urlsplit

from rastrainer.errors import InputError
from rastrainer.files.writing import make_folder

SCHEMES = ("postgresql://", "postgres://")
EXAMPLE = "postgresql://USER@HOST/DATABASE"
OPTIONS = ("sslmode", "sslrootcert", "sslcert", "sslkey", "passfile", "host", "port")
"""What an address may say after its question mark."""
SAFE_MODES = ("verify-full", "verify-ca")
"""Values of `sslmode` by which nobody between two computers can read along or answer instead."""
_HERE = ("localhost", "127.0.0.1", "::1")
_MAX_LENGTH = 1000


@dataclass(frozen=True)
class PostgresAddress:
    """A database of a PostgreSQL server.

    Attributes:
        host: name or number of its computer, or the folder of its socket on this one.
        database: its name.
        user: the role; "" for the name of the system's user.
        port: None for 5432.
        options: of libpq, such as `sslmode`.
    """

    host: str
    database: str
    user: str = ""
    port: int | None = None
    options: Mapping[str, str] = field(default_factory=dict)

    def __str__(self) -> str:
        """Return it as `study_place` reads it."""
        is_folder = self.host.startswith("/")
        user = f"{quote(self.user, safe='')}@" if self.user else ""
        host = "" if is_folder else f"[{self.host}]" if ":" in self.host else self.host
        port = "" if self.port is None else f":{self.port}"
        options = {**self.options, **({"host": self.host} if is_folder else {})}
        if is_folder and self.port is not None:
            port, options["port"] = "", str(self.port)
        end = f"?{urlencode(options, safe='/')}" if options else ""
        return f"{SCHEMES[0]}{user}{host}{port}/{quote(self.database, safe='')}{end}"

    @property
    def connection_words(self) -> dict[str, str]:
        """What libpq is told."""
        words = {"host": self.host, "dbname": self.database, **self.options}
        if self.user:
            words["user"] = self.user
        if self.port is not None:
            words["port"] = str(self.port)
        if not self.is_here:
            words.setdefault("sslmode", SAFE_MODES[0])
        return words

    @property
    def is_here(self) -> bool:
        """Whether its server runs on this computer."""
        return self.host in _HERE or self.host.startswith("/")


StudyPlace = Path | PostgresAddress
"""Where a study is: the path of its file, or the address of its database."""


def study_place(place: str | os.PathLike[str] | PostgresAddress) -> StudyPlace:
    """Return where a study is, from what a user has entered.

    Raises:
        InputError: an address of PostgreSQL that cannot be used, with what would be right.
    """
    if isinstance(place, PostgresAddress):
        return place
    text = os.fspath(place)
    return _address(text) if text.startswith(SCHEMES) else Path(text)


def _address(text: str) -> PostgresAddress:
    # No sentence repeats what was entered: it might hold a password.
    if len(text) > _MAX_LENGTH or not text.isprintable():
        raise InputError(f"An address of PostgreSQL is printable text such as {EXAMPLE}.")
    try:
        parts = urlsplit(text)
        port, password = parts.port, parts.password
        pairs = parse_qsl(parts.query, keep_blank_values=True, strict_parsing=bool(parts.query))
    except ValueError:
        raise InputError(f"An address of PostgreSQL looks like {EXAMPLE}.") from None
    options = dict(pairs)
    if password is not None or "password" in options:
        raise InputError(
            "The address of a study must not hold a password, which would be kept in settings and "
            "seen by others. Put it into ~/.pgpass as HOST:PORT:DATABASE:USER:PASSWORD, readable "
            "by you alone."
        )
    unknown = sorted(set(options) - set(OPTIONS))
    if unknown or len(options) < len(pairs):
        raise InputError(
            "After its question mark, the address of a study may have each of "
            f"{', '.join(OPTIONS)} once."
        )
    host = options.pop("host", "") or parts.hostname or ""
    database = unquote(parts.path.removeprefix("/"))
    if not host or not database or "/" in database or "," in host or parts.fragment:
        raise InputError(f"The address of a study names a host and a database: {EXAMPLE}.")
    if "port" in options:
        port = _port(options.pop("port"))
    user = unquote(parts.username or "")
    if not "".join((host, database, user, *options.values())).isprintable():
        raise InputError(f"An address of PostgreSQL is printable text such as {EXAMPLE}.")
    address = PostgresAddress(host, database, user, port, options)
    if not address.is_here and address.connection_words["sslmode"] not in SAFE_MODES:
        raise InputError(
            "A study on another computer is reached over TLS with a certificate that is checked: "
            f"leave sslmode out, or set it to {' or '.join(SAFE_MODES)}."
        )
    return address


def _port(text: str) -> int:
    if not text.isdecimal() or not 0 < int(text[:6]) < 65536:
        raise InputError("The port of a study is a number from 1 to 65535.")
    return int(text)


def beside_study(place: StudyPlace) -> Path:
    """Return the path whose name begins those of files beside a study, such as what was sent where.

    That of the study's file; for a study in PostgreSQL one in the user's own folder, by its
    address.

    Raises:
        InputError: that folder cannot be made.
    """
    if isinstance(place, Path):
        return place
    folder = Path.home() / "RASTrainer" / "studies"
    make_folder(folder, is_private=True)
    # Not by the role or the options: another one leads to the same study.
    where = f"{place.host}:{place.port or 5432}/{place.database}"
    return folder / hashlib.sha256(where.encode()).hexdigest()[:16]
