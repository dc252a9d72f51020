"""What clients, views and trials may cost, as settings with sane defaults, and their file."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any, TypeVar

from rastrainer.errors import InputError
from rastrainer.files.reading import read_json
from rastrainer_simulator.loop.timing import TrialLimits

LIMITS_FILE = "limits.json"
MAX_BYTES = 2**14
LARGEST = {"_share": 1, "_bytes": 2**30, "_per_s": 2**20, "_s": 86_400}
"""By how a limit's name ends: a limit that limits nothing is a mistake."""
LARGEST_COUNT = 2**16


@dataclasses.dataclass(frozen=True)
class LinkLimits:
    """Limits of the OpenIGTLink server; the largest message is `rastrainer.igtl`'s own limit.

    Attributes:
        clients: connections at a time; a further one replaces the oldest that has never sent a
            message, and is closed immediately if all have.
        new_clients_per_s: connections that are taken in a second; further ones wait.
        message_bytes: body of a message that is waited for; a longer one is passed over.
        reading_share: of one core for reading; the connections share it evenly.
        first_message_s: time that a client has to show by its first message which header version
            it speaks; then it is taken for a listener of version 2.
        slow_client_s: time after which a client that does not read is dropped.
        half_message_s: time after which a client is dropped that leaves a message half sent, or
            brings the rest of it at less than
        slowest_bytes_per_s: bytes a second.
        silent_peer_s: time after which a peer is dropped whose machine does not answer any more.
        buffer_bytes: passed to the operating system ahead of a client that reads slowly.
        waiting_bytes: bytes that may wait for a client; one more drops it.
        commands_at_once: commands of one client that are submitted to the control loop at a time.
        waiting_commands: further commands, and
        waiting_command_bytes: bytes of them that may wait for their turn; one more is refused.
        reconnect_s: pause between two attempts to reach a listening Slicer.
    """

    clients: int = 128
    new_clients_per_s: float = 50.0
    message_bytes: int = 72 * 1024
    reading_share: float = 0.3
    first_message_s: float = 0.25
    slow_client_s: float = 5.0
    half_message_s: float = 10.0
    slowest_bytes_per_s: float = 16 * 1024
    silent_peer_s: float = 20.0
    buffer_bytes: int = 64 * 1024
    waiting_messages: int = 4096
    waiting_bytes: int = 4 * 2**20
    commands_at_once: int = 16
    waiting_commands: int = 4096
    waiting_command_bytes: int = 2**20
    reconnect_s: float = 1.0


@dataclasses.dataclass(frozen=True)
class ViewLimits:
    """Limits of the view server.

    Attributes:
        views: streams at a time; further ones are refused.
        spectators: streams at a time of those who were paired to watch only, beside the views;
            further ones are refused.
        connections: of any kind at a time; a further one replaces the oldest that has shown no
            key, and is closed immediately if all have.
        new_connections_per_s: that are taken in a second; further ones wait.
        requests_per_s: of all connections together; further ones wait for their turn.
        sessions: keys that are remembered; the oldest is forgotten.
        spectator_sessions: keys of spectators, likewise.
        message_bytes: of one message from a view.
        messages_per_s: that a view may send on average, and at most that many at once.
        first_message_s: time that a connection has to agree on a key, for its first request, and a
            view for its hello.
        silent_s: after which what a silent view holds is released.
        lost_s: after which a view that reported its frames every second counts as not seen.
        state_hz: how often views are sent what moves.
        waiting_events: events that may wait for a view; one more drops it.
        buffer_bytes: passed to the operating system ahead of a view that reads slowly.
        gone_s: time without any sign of life after which a view counts as gone.
    """

    views: int = 32
    spectators: int = 16
    connections: int = 128
    new_connections_per_s: float = 50.0
    requests_per_s: float = 200.0
    sessions: int = 64
    spectator_sessions: int = 64
    message_bytes: int = 16 * 1024
    messages_per_s: float = 500.0
    first_message_s: float = 5.0
    silent_s: float = 0.5
    lost_s: float = 5.0
    state_hz: float = 60.0
    waiting_events: int = 256
    buffer_bytes: int = 32 * 1024
    gone_s: float = 30.0


T = TypeVar("T", LinkLimits, ViewLimits, TrialLimits)


@dataclasses.dataclass(frozen=True)
class ServerLimits:
    """What everyone at the server's ports may cost.

    Attributes:
        clients: those over OpenIGTLink.
        views: the window, browsers and headsets.
        trials: started by any of these.
    """

    clients: LinkLimits = dataclasses.field(default_factory=LinkLimits)
    views: ViewLimits = dataclasses.field(default_factory=ViewLimits)
    trials: TrialLimits = dataclasses.field(default_factory=TrialLimits)


def read_limits(folder: Path) -> ServerLimits:
    """Return the limits that the file in a folder sets; missing ones have their defaults."""
    path = folder / LIMITS_FILE
    if not path.exists():
        return ServerLimits()
    groups = [field.name for field in dataclasses.fields(ServerLimits)]
    values = read_json(path, MAX_BYTES)
    if not isinstance(values, dict) or not values.keys() <= set(groups):
        raise InputError(f"{path} must be a JSON object with any of {', '.join(groups)}.")
    defaults = ServerLimits()
    return ServerLimits(
        clients=_changed(path, "clients", defaults.clients, values),
        views=_changed(path, "views", defaults.views, values),
        trials=_changed(path, "trials", defaults.trials, values),
    )


def _changed(path: Path, group: str, limits: T, groups: dict[str, Any]) -> T:
    """Return the limits of a group with what the file sets."""
    values = groups.get(group, {})
    defaults = {field.name: getattr(limits, field.name) for field in dataclasses.fields(limits)}
    if not isinstance(values, dict) or not values.keys() <= defaults.keys():
        listed = ", ".join(defaults)
        raise InputError(f"{path}: {group} must be a JSON object with any of {listed}.")
    for name, value in values.items():
        is_whole = isinstance(defaults[name], int)
        most = next((most for end, most in LARGEST.items() if name.endswith(end)), LARGEST_COUNT)
        if type(value) not in ((int,) if is_whole else (int, float)) or not 0 < value <= most:
            what = "whole number" if is_whole else "number"
            raise InputError(f"{path}: {group}.{name} must be a {what} above 0, up to {most}.")
    return dataclasses.replace(limits, **values)
