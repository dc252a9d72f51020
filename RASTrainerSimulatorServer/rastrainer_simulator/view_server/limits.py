"""What views may cost, as settings with sane defaults."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ViewLimits:
    """Limits of the view server.

    Attributes:
        views: streams at once; further ones are refused.
        connections: of any kind at once; one more takes the place of the oldest that has shown no
            key, and is closed at once where all have.
        new_connections_per_s: that are taken in a second; further ones wait.
        requests_per_s: of all connections together; further ones wait for their turn.
        sessions: keys that are remembered; the oldest is forgotten.
        message_bytes: of one message from a view.
        messages_per_s: that a view may send on average, and at most that many at once.
        first_message_s: time that a connection has to agree on a key, for its first request, and a
            view for its hello.
        silent_s: after which what a silent view holds is released.
        lost_s: after which a view that told its frames every second counts as not seen.
        state_hz: how often views are told what moves.
        waiting_events: events that may wait for a view; one more drops it.
        buffer_bytes: what is handed to the operating system ahead of a view that reads slowly.
        gone_s: time without any sign of life after which a view counts as gone.
    """

    views: int = 32
    connections: int = 128
    new_connections_per_s: float = 50.0
    requests_per_s: float = 200.0
    sessions: int = 64
    message_bytes: int = 16 * 1024
    messages_per_s: float = 500.0
    first_message_s: float = 5.0
    silent_s: float = 0.5
    lost_s: float = 5.0
    state_hz: float = 60.0
    waiting_events: int = 256
    buffer_bytes: int = 32 * 1024
    gone_s: float = 30.0
