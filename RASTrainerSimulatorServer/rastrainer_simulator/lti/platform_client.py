"""Requests to learning platforms: bounded in size and time, and never redirected."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from typing import Any

import aiohttp

from rastrainer.errors import InputError
from rastrainer.finite_json import decode_finite_json

TIMEOUT_S = 20.0
MAX_ANSWER_BYTES = 100_000
BUSY = (401, 408, 425, 429)
"""Statuses by which a platform asks for patience, or for another token."""


class PlatformAwayError(InputError):
    """The platform does not answer as it should: the same may be asked later."""


class PlatformClient:
    """Asks platforms; use it in an `async with` statement."""

    def __init__(self, timeout_s: float = TIMEOUT_S) -> None:
        """Give up what has taken so long."""
        self._timeout = aiohttp.ClientTimeout(total=timeout_s)

    async def __aenter__(self) -> PlatformClient:
        """Open it."""
        self._session = aiohttp.ClientSession(
            timeout=self._timeout, cookie_jar=aiohttp.DummyCookieJar()
        )
        return self

    async def __aexit__(self, *_exception: object) -> None:
        """Close it."""
        await self._session.close()

    async def json(self, url: str, form: Mapping[str, str] | None = None) -> Any:
        """Return the JSON at an address, or that answers a form.

        Raises:
            PlatformAwayError: there is none.
        """
        status, content = await self._ask("GET" if form is None else "POST", url, data=form)
        if status >= 300:
            raise PlatformAwayError(f"it answers with status {status}")
        try:
            return decode_finite_json(content.decode())
        except ValueError:
            raise PlatformAwayError("its answer is not JSON") from None

    async def send(self, url: str, body: bytes, kind: str, token: str) -> int:
        """Send something, and return the status of the answer.

        Raises:
            PlatformAwayError: there is no answer, or one that asks for patience.
        """
        headers = {"Content-Type": kind, "Authorization": f"Bearer {token}"}
        status, _content = await self._ask("POST", url, data=body, headers=headers)
        if status in BUSY or status >= 500:
            raise PlatformAwayError(f"it answers with status {status}")
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
                        raise PlatformAwayError("its answer is too large")
                return answer.status, bytes(content)
        except (aiohttp.ClientError, OSError, ValueError, asyncio.TimeoutError) as error:
            reason = str(error) or type(error).__name__
            raise PlatformAwayError(f"it does not answer ({reason[:200]})") from None
