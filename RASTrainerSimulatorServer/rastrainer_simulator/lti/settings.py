"""The lab's private files: which learning platforms may launch, and the key of this tool."""

from __future__ import annotations

import contextlib
import dataclasses
import hashlib
import os
import time
import uuid
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import jwt
from cryptography.hazmat.primitives import serialization
from cryptography.hazmat.primitives.asymmetric import rsa
from jwt.algorithms import RSAAlgorithm

from rastrainer.errors import InputError
from rastrainer.files.json_fields import known_keys
from rastrainer.files.reading import failure_reason, printable_name, read_json
from rastrainer.files.writing import write_private_json
from rastrainer.json_checks import Argument, text, texts, yes_or_no
from rastrainer_simulator.net.listener import is_loopback

SETTINGS_FILE = "lti.json"
MOST_PLATFORMS = 20
_MAX_BYTES = 100_000
LOGIN, LAUNCH, KEYS = "/login", "/launch", "/jwks"


def https_url(value: Any) -> str:
    """Accept the address of a page: https, except on this computer, without a name or password."""
    try:
        parts = urlsplit(text(500)(value))
        is_usable = bool(parts.hostname) and not ("@" in parts.netloc or parts.fragment)
        is_safe = parts.scheme == "https" or is_loopback(parts.hostname or "")
        _port = parts.port
    except ValueError:
        is_usable = is_safe = False
    if not is_usable or not is_safe or parts.scheme not in ("https", "http"):
        raise ValueError("an address such as https://courses.example.org/page")
    return value


def origin(url: str) -> str:
    """Return scheme, host and port of a checked address."""
    parts = urlsplit(url)
    port = parts.port or {"https": 443, "http": 80}[parts.scheme]
    return f"{parts.scheme}://{parts.hostname}:{port}"


def _own_address(value: Any) -> str:
    address = https_url(value).rstrip("/")
    if urlsplit(address).query:
        raise ValueError("an address without a query")
    return address


@dataclasses.dataclass(frozen=True)
class LearningPlatform:
    """A learning platform, as its administrator has registered this tool there.

    Attributes:
        name: For people in the lab.
        issuer: That signs its messages.
        client_id: Of this tool there.
        deployment_ids: That may launch.
        authentication_url: Where a browser is sent to be identified.
        token_url: That gives access to its services.
        key_set_url: Of its public keys.
        token_audience: Whom requests for access are addressed to; "" for `token_url`.
        line_item_origins: Further servers of it that take grades.
        sends_grades: Whether grades are returned to it.
    """

    name: str
    issuer: str
    client_id: str
    deployment_ids: tuple[str, ...]
    authentication_url: str
    token_url: str
    key_set_url: str
    token_audience: str
    line_item_origins: tuple[str, ...]
    sends_grades: bool

    def takes_grades_at(self, url: object) -> bool:
        """Return whether an address from a launch is one of its own, which may see our token."""
        own = (self.authentication_url, self.token_url, self.key_set_url, *self.line_item_origins)
        try:
            return origin(https_url(url)) in {origin(each) for each in own}
        except ValueError:
            return False


_PLATFORM_KEYS = {
    "name": Argument(text(60)),
    "issuer": Argument(https_url),
    "clientId": Argument(text(255)),
    "deploymentIds": Argument(texts(1, 50)),
    "authenticationUrl": Argument(https_url),
    "tokenUrl": Argument(https_url),
    "keySetUrl": Argument(https_url),
    "tokenAudience": Argument(text(500), ""),
    "lineItemOrigins": Argument(texts(0, 10), ()),
    "sendGrades": Argument(yes_or_no, True),
}


@dataclasses.dataclass(frozen=True)
class LtiSettings:
    """The settings.

    Attributes:
        address: By which browsers reach this tool.
        platforms: That may launch.
    """

    address: str
    platforms: tuple[LearningPlatform, ...]

    @property
    def launch_url(self) -> str:
        """Where platforms send launches to."""
        return f"{self.address}{LAUNCH}"

    def platform(self, issuer: str, client_id: str) -> LearningPlatform | None:
        """Return a platform; without a client ID, the only one of its issuer; None if unknown."""
        found = [
            each
            for each in self.platforms
            if each.issuer == issuer and client_id in ("", each.client_id)
        ]
        return found[0] if len(found) == 1 else None


def read_lti_settings(config: Path) -> LtiSettings:
    """Return the settings in a folder."""
    path = config / SETTINGS_FILE
    what = printable_name(path)
    if not path.exists():
        raise InputError(
            f"There is no {what}. Make it with the address by which browsers reach this computer, "
            'such as {"address": "https://rastrainer.example.org", "platforms": []}.'
        )
    values = read_json(path, _MAX_BYTES)
    keys = {"address": Argument(_own_address), "platforms": Argument(_list_of_platforms)}
    checked = known_keys(values, keys, what)
    platforms = tuple(
        _platform(each, f"{what}: platform {number}")
        for number, each in enumerate(checked["platforms"], 1)
    )
    names = [(each.issuer, each.client_id) for each in platforms]
    if len(set(names)) < len(names):
        raise InputError(f"{what}: two platforms have the same issuer and clientId.")
    return LtiSettings(checked["address"], platforms)


def _list_of_platforms(value: Any) -> list[Any]:
    if not isinstance(value, list) or len(value) > MOST_PLATFORMS:
        raise ValueError(f"a list of up to {MOST_PLATFORMS} platforms")
    return value


def _platform(value: Any, what: str) -> LearningPlatform:
    checked = known_keys(value, _PLATFORM_KEYS, what)
    for each in checked["lineItemOrigins"]:
        try:
            https_url(each)
        except ValueError as error:
            raise InputError(f"{what}: each of lineItemOrigins must be {error}.") from None
    return LearningPlatform(*checked.values())


KEY_FILE = "lti-key.json"
BITS = 2048
ALGORITHM = "RS256"
VALID_S = 60
_MAX_KEY_BYTES = 20_000
_OTHERS = 0o077


class ToolKey:
    """The key, in a file that only its owner can read."""

    def __init__(self, config: Path) -> None:
        """Read the key in a folder of settings, or make one."""
        path = config / KEY_FILE
        if not path.exists():
            _make(path)
        self._private = _read(path)
        public = self._private.public_key()
        der = public.public_bytes(
            serialization.Encoding.DER, serialization.PublicFormat.SubjectPublicKeyInfo
        )
        self._key_id = hashlib.sha256(der).hexdigest()[:32]
        self.public_pem = public.public_bytes(
            serialization.Encoding.PEM, serialization.PublicFormat.SubjectPublicKeyInfo
        ).decode()
        """Public key for platforms that are given it instead of an address."""

    def key_set(self) -> dict[str, Any]:
        key = RSAAlgorithm.to_jwk(self._private.public_key(), as_dict=True)
        return {"keys": [{**key, "kid": self._key_id, "alg": ALGORITHM, "use": "sig"}]}

    def assertion(self, client_id: str, audience: str) -> str:
        """Return a signed token by which a platform recognizes this tool, valid once, for 60 s."""
        now = int(time.time())
        claims = {
            "iss": client_id,
            "sub": client_id,
            "aud": audience,
            "iat": now,
            "exp": now + VALID_S,
            "jti": str(uuid.uuid4()),
        }
        return jwt.encode(claims, self._private, ALGORITHM, headers={"kid": self._key_id})


def _make(path: Path) -> None:
    """Make the key, unless another process that has just started is first: then its key stays."""
    key = rsa.generate_private_key(public_exponent=65_537, key_size=BITS)
    pem = key.private_bytes(
        serialization.Encoding.PEM,
        serialization.PrivateFormat.PKCS8,
        serialization.NoEncryption(),
    )
    own = path.with_name(f".{uuid.uuid4().hex}.partial")
    write_private_json(own, {"privateKey": pem.decode()})
    try:
        # Never in place of another, and whole from the beginning.
        with contextlib.suppress(FileExistsError):
            os.link(own, path)
    except OSError as error:
        raise InputError(
            f"{printable_name(path)} cannot be made: {failure_reason(error)}."
        ) from None
    finally:
        own.unlink()


def _read(path: Path) -> rsa.RSAPrivateKey:
    values = read_json(path, _MAX_KEY_BYTES)
    if os.name == "posix" and path.stat().st_mode & _OTHERS:
        raise InputError(
            f"Others can read {printable_name(path)}; restrict it to yourself with chmod 600."
        )
    try:
        key = serialization.load_pem_private_key(values["privateKey"].encode(), password=None)
    except (TypeError, KeyError, AttributeError, ValueError):
        key = None
    if not isinstance(key, rsa.RSAPrivateKey):
        raise InputError(
            f"{printable_name(path)} contains no private key; move it away, and a new one is made, "
            "which must then be registered with each platform."
        )
    return key
