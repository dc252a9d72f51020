"""The public keys of learning platforms, from the addresses in the settings and nowhere else."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable
from typing import Any

import jwt
from cryptography.hazmat.primitives.asymmetric.rsa import RSAPublicKey

from rastrainer_simulator.lti.platform_client import PlatformAwayError, PlatformClient
from rastrainer_simulator.lti.tool_key import ALGORITHM

MOST_KEYS = 30
KEPT_S = 3600.0
"""After which keys are asked for again, so that one that was withdrawn counts no longer."""
REST_S = 30.0
"""Between two requests: tokens with made-up key IDs cause no more of them."""
SHORTEST_BITS, LONGEST_BITS = 2048, 8192


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
            PlatformAwayError: the keys cannot be had.
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
                raise PlatformAwayError("its keys could not be had a moment ago")
            return known.get(key_id)


def _usable(answer: Any) -> dict[str, RSAPublicKey]:
    """Return the keys for our algorithm by their IDs; what is no such key is left out."""
    listed = answer.get("keys") if isinstance(answer, dict) else None
    if not isinstance(listed, list) or len(listed) > MOST_KEYS:
        raise PlatformAwayError(f"it does not answer with up to {MOST_KEYS} keys")
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
