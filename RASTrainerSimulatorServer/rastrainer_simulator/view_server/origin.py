"""From where a request may come: this computer's own names, and our own page."""

from __future__ import annotations

import ipaddress
import socket

from aiohttp import web

WRONG_HOST = "The simulator is not known under this name: use its address."
FOREIGN = "A page of another origin may not connect."


def check_origin(request: web.Request) -> None:
    """Let a request pass if it is for us and, from a browser, from our own page.

    A name that somebody else's name server points here (DNS rebinding) is not ours.

    Raises:
        web.HTTPForbidden: it may not pass.
    """
    if not _is_own_name(_without_port(request.host)):
        raise web.HTTPForbidden(text=WRONG_HOST)
    origin = request.headers.get("Origin")
    if origin is not None and origin != f"{request.scheme}://{request.host}":
        raise web.HTTPForbidden(text=FOREIGN)


def _without_port(host: str) -> str:
    name, colon, port = host.rpartition(":")
    return name if colon and port.isdecimal() else host


def _is_own_name(name: str) -> bool:
    bare = name.removeprefix("[").removesuffix("]")
    try:
        ipaddress.ip_address(bare)
    except ValueError:
        own = socket.gethostname().lower().removesuffix(".local")
        return bare.lower() in ("localhost", own, f"{own}.local")
    return True
