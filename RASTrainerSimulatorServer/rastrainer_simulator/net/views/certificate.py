"""A certificate for HTTPS in a local network, made on this machine and kept by its user."""

from __future__ import annotations

import contextlib
import hashlib
import socket
import ssl
from dataclasses import dataclass
from datetime import datetime, timedelta, timezone
from ipaddress import ip_address
from pathlib import Path

import trustme

from rastrainer.errors import InputError
from rastrainer.files.writing import make_private_folder, write_bytes, write_text

VALID_DAYS = 90
RENEWED_BEFORE_DAYS = 14
FILE_NAME = "views.pem"
NAMES_NAME = "views.names"


@dataclass(frozen=True)
class Certificate:
    """This machine's certificate, and its SHA-256 fingerprint as browsers show it."""

    tls: ssl.SSLContext
    fingerprint: str


def own_certificate(folder: Path) -> Certificate:
    """Return this machine's certificate, renewed when old or when addresses changed.

    The file holds the private key: only its owner can read it, and it never leaves the machine.
    """
    file, names_file = folder / FILE_NAME, folder / NAMES_NAME
    host = socket.gethostname().lower().removesuffix(".local")
    names = ("localhost", host, f"{host}.local", "127.0.0.1", "::1", *own_addresses())
    try:
        make_private_folder(folder)
        # None yet, or an incomplete one, as after a full disk, is replaced.
        with contextlib.suppress(FileNotFoundError, ssl.SSLError):
            made_for = names_file.read_text(encoding="utf-8").split()
            made = datetime.fromtimestamp(file.stat().st_mtime, timezone.utc)
            age = datetime.now(timezone.utc) - made
            is_young = timedelta(0) <= age < timedelta(days=VALID_DAYS - RENEWED_BEFORE_DAYS)
            if is_young and set(names) <= set(made_for):
                return _read(file)
        authority = trustme.CA(organization_name="RASTrainer on this machine")
        until = datetime.now(timezone.utc) + timedelta(days=VALID_DAYS)
        issued = authority.issue_cert(*names, not_after=until)
        write_bytes(file, issued.private_key_and_cert_chain_pem.bytes(), is_private=True)
        write_text(names_file, "\n".join(names))
        return _read(file)
    except OSError as error:
        raise InputError(
            f"The certificate for the local network cannot be kept in {folder}: {error.strerror}. "
            "Allow writing to it, or choose another folder of settings."
        ) from None


def own_addresses() -> tuple[str, ...]:
    """Return the addresses of this machine in its networks, the most usable first."""
    found: list[str] = []
    with contextlib.suppress(OSError), socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        # Nothing is sent: this only looks up the route to an address reserved for documentation.
        probe.connect(("192.0.2.1", 9))
        found.append(probe.getsockname()[0])
    with contextlib.suppress(OSError):
        found += [str(entry[4][0]) for entry in socket.getaddrinfo(socket.gethostname(), None)]
    usable = [text.partition("%")[0] for text in found]
    return tuple(dict.fromkeys(text for text in usable if not ip_address(text).is_loopback))


def _read(file: Path) -> Certificate:
    while True:
        content = file.read_bytes()
        tls = ssl.create_default_context(ssl.Purpose.CLIENT_AUTH)
        tls.minimum_version = ssl.TLSVersion.TLSv1_2
        tls.load_cert_chain(file)
        # Another simulator that starts at the same time may just have made its own.
        if file.read_bytes() == content:
            _before, begin, rest = content.decode("ascii").partition(ssl.PEM_HEADER)
            pem = begin + "".join(rest.partition(ssl.PEM_FOOTER)[:2])
            digest = hashlib.sha256(ssl.PEM_cert_to_DER_cert(pem)).digest()
            return Certificate(tls, digest.hex(":").upper())
