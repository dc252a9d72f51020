"""Requests to learning platforms, bounded in size and time and never redirected; and their keys.

The public keys come from the addresses in the settings and from nowhere else.
"""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable, Mapping
from typing import Any

import aiohttp
import jwt
from cryptography.hazmat.primitives.asymmetric.rsa import RSAPublicKey

from rastrainer.errors import InputError
from rastrainer.json_checks import decode_finite_json
from rastrainer_simulator.lti.settings import ALGORITHM

TIMEOUT_S = 20.0
MAX_ANSWER_BYTES = 100_000
BUSY = (401, 408, 425, 429)
"""Statuses by which a platform asks for patience, or for another token."""
MOST_KEYS = 30
KEPT_S = 3600.0
"""Time after which keys are fetched again, so that a revoked one is no longer accepted."""
REST_S = 30.0
"""Time between two requests: tokens with made-up key IDs cause no more of them."""
SHORTEST_BITS, LONGEST_BITS = 2048, 8192


class PlatformUnreachableError(InputError):
    """The platform does not answer as it should: the request may be repeated later."""


class PlatformClient:
    """Sends requests to platforms; use it in an `async with` statement."""

    def __init__(self, timeout_s: float = TIMEOUT_S) -> None:
        """Give up requests that take longer than `timeout_s`."""
        self._timeout = aiohttp.ClientTimeout(total=timeout_s)

    async def __aenter__(self) -> PlatformClient:
        """Open it."""
        self._session = aiohttp.ClientSession(
            timeout=self._timeout, cookie_jar=aiohttp.DummyCookieJar()
        )
        return self

    async def __aexit__(self, *_exception: object) -> None:
        await self._session.close()

    async def json(self, url: str, form: Mapping[str, str] | None = None) -> Any:
        """Return the JSON at an address, or that answers a form.

        Raises:
            PlatformUnreachableError: there is none.
        """
        status, content = await self._ask("GET" if form is None else "POST", url, data=form)
        if status >= 300:
            raise PlatformUnreachableError(f"it answers with status {status}")
        try:
            return decode_finite_json(content.decode())
        except ValueError:
            raise PlatformUnreachableError("its answer is not JSON") from None

    async def send(self, url: str, body: bytes, kind: str, token: str) -> int:
        """Send something, and return the status of the answer.

        Raises:
            PlatformUnreachableError: there is no answer, or one that asks for patience.
        """
        headers = {"Content-Type": kind, "Authorization": f"Bearer {token}"}
        status, _content = await self._ask("POST", url, data=body, headers=headers)
        if status in BUSY or status >= 500:
            raise PlatformUnreachableError(f"it answers with status {status}")
        return status

    async def _ask(self, method: str, url: str, **options: Any) -> tuple[int, bytes]:
        try:
            async with self._session.request(
                method, url, allow_redirects=False, **options
            ) as answer:
                content = bytearray()
                async for piece in answer.content.iter_chunked(2**14):
                    content += piece
                    if len(content) > MAX_ANSWER_BYTES:
                        raise PlatformUnreachableError("its answer is too large")
                return answer.status, bytes(content)
        except (aiohttp.ClientError, OSError, ValueError, asyncio.TimeoutError) as error:
            reason = str(error) or type(error).__name__
            raise PlatformUnreachableError(f"it does not answer ({reason[:200]})") from None


class KeySets:
    """Keys by platform, kept for an hour."""

    def __init__(self, client: PlatformClient, clock: Callable[[], float]) -> None:
        """Keep no key yet; `clock` returns s."""
        self._client, self._clock = client, clock
        self._keys: dict[str, dict[str, RSAPublicKey]] = {}
        self._fetched: dict[str, float] = {}
        self._asked: dict[str, float] = {}
        self._locks: dict[str, asyncio.Lock] = {}

    async def key(self, url: str, key_id: str) -> RSAPublicKey | None:
        """Return a key of the set at an address of the settings; None if it is not there.

        Raises:
            PlatformUnreachableError: the keys cannot be fetched.
        """
        async with self._locks.setdefault(url, asyncio.Lock()):
            now = self._clock()
            is_fresh = now - self._fetched.get(url, -math.inf) < KEPT_S
            known = self._keys[url] if is_fresh else None
            if (known is None or key_id not in known) and now - self._asked.get(
                url, -math.inf
            ) > REST_S:
                self._asked[url] = now
                known = _usable(await self._client.json(url))
                self._keys[url], self._fetched[url] = known, now
            if known is None:
                raise PlatformUnreachableError("its keys could not be fetched a moment ago")
            return known.get(key_id)


def _usable(answer: Any) -> dict[str, RSAPublicKey]:
    """Return the keys for our algorithm by their IDs; what is no such key is left out."""
    listed = answer.get("keys") if isinstance(answer, dict) else None
    if not isinstance(listed, list) or len(listed) > MOST_KEYS:
        raise PlatformUnreachableError(f"its answer is not a list of at most {MOST_KEYS} keys")
    found: dict[str, RSAPublicKey] = {}
    for each in listed:
        if not isinstance(each, dict) or not isinstance(each.get("kid"), str):
            continue
        if each.get("kty") != "RSA" or each.get("alg", ALGORITHM) != ALGORITHM:
            continue
        try:
            key = jwt.PyJWK(each, ALGORITHM).key
        except (jwt.PyJWTError, ValueError, TypeError):
            continue
        if isinstance(key, RSAPublicKey) and SHORTEST_BITS <= key.key_size <= LONGEST_BITS:
            found[each["kid"]] = key
    return found
