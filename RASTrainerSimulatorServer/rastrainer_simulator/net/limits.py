"""What clients, views and trials may cost, as settings with sane defaults, and their file."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from rastrainer.files.reading import read_json
from rastrainer.json_records import record_from_json
from rastrainer_simulator.loop.timing import TrialLimits, above_zero

LIMITS_FILE = "limits.json"
MAX_BYTES = 2**14
Share = Annotated[float, above_zero(1)]
Bytes = Annotated[int, above_zero(2**30, is_whole=True)]
Rate = Annotated[float, above_zero(2**20)]
Seconds = Annotated[float, above_zero(86_400)]
Count = Annotated[int, above_zero(2**16, is_whole=True)]


@dataclass(frozen=True)
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

    clients: Count = 128
    new_clients_per_s: Rate = 50.0
    message_bytes: Bytes = 72 * 1024
    reading_share: Share = 0.3
    first_message_s: Seconds = 0.25
    slow_client_s: Seconds = 5.0
    half_message_s: Seconds = 10.0
    slowest_bytes_per_s: Rate = 16 * 1024
    silent_peer_s: Seconds = 20.0
    buffer_bytes: Bytes = 64 * 1024
    waiting_messages: Count = 4096
    waiting_bytes: Bytes = 4 * 2**20
    commands_at_once: Count = 16
    waiting_commands: Count = 4096
    waiting_command_bytes: Bytes = 2**20
    reconnect_s: Seconds = 1.0


@dataclass(frozen=True)
class ViewLimits:
    """Limits of the view server.

    Attributes:
        views: streams at a time; further ones are refused.
        spectators: streams at a time of those who were paired to watch only, beside the views.
        connections: of any kind at a time; a further one replaces the oldest that has shown no
            key, and is closed immediately if all have.
        messages_per_s: that a view may send on average, and at most that many at once.
        first_message_s: time that a connection has to agree on a key, for its first request, and a
            view for its hello.
        silent_s: after which what a silent view holds is released.
        lost_s: after which a view that reported its frames every second counts as not seen.
        gone_s: time without any sign of life after which a view counts as gone.
    """

    views: Count = 32
    spectators: Count = 16
    connections: Count = 128
    messages_per_s: Rate = 500.0
    first_message_s: Seconds = 5.0
    silent_s: Seconds = 0.5
    lost_s: Seconds = 5.0
    gone_s: Seconds = 30.0


@dataclass(frozen=True)
class ServerLimits:
    """What everyone at the server's ports may cost.

    Attributes:
        clients: those over OpenIGTLink.
        views: the window, browsers and headsets.
        trials: started by any of these.
    """

    clients: LinkLimits = field(default_factory=LinkLimits)
    views: ViewLimits = field(default_factory=ViewLimits)
    trials: TrialLimits = field(default_factory=TrialLimits)


def read_limits(folder: Path) -> ServerLimits:
    """Return the limits that the file in a folder sets; missing ones have their defaults."""
    path = folder / LIMITS_FILE
    if not path.exists():
        return ServerLimits()
    return record_from_json(ServerLimits, read_json(path, MAX_BYTES), str(path), only_known=True)
