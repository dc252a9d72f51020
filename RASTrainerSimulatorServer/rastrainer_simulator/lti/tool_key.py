"""This tool's private key, made once, with which it signs what it sends to platforms."""

from __future__ import annotations

import contextlib
import hashlib
import os
import time
import uuid
from pathlib import Path
from typing import Any

import jwt
from cryptography.hazmat.primitives import serialization
from cryptography.hazmat.primitives.asymmetric import rsa
from jwt.algorithms import RSAAlgorithm

from rastrainer.errors import InputError
from rastrainer.files.reading import failure_reason, printable_name, read_json
from rastrainer.files.writing import write_private_json

KEY_FILE = "lti-key.json"
BITS = 2048
ALGORITHM = "RS256"
VALID_S = 60
_MAX_BYTES = 20_000
_OTHERS = 0o077


class ToolKey:
    """The key, in a file that only its owner can read."""

    def __init__(self, config: Path) -> None:
        """Read the key in a folder of settings, or make one.

        Raises:
            InputError: the file cannot be read or written, holds no key, or others can read it.
        """
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
        """Return the public key as a JSON Web Key Set."""
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
    values = read_json(path, _MAX_BYTES)
    if os.name == "posix" and path.stat().st_mode & _OTHERS:
        raise InputError(
            f"Others can read {printable_name(path)}; make it yours alone with chmod 600."
        )
    try:
        key = serialization.load_pem_private_key(values["privateKey"].encode(), password=None)
    except (TypeError, KeyError, AttributeError, ValueError):
        key = None
    if not isinstance(key, rsa.RSAPrivateKey):
        raise InputError(
            f"{printable_name(path)} holds no private key; move it away, and a new one is made, "
            "which each platform must be given."
        )
    return key
