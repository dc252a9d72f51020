"""What clients may cost, as settings with sane defaults."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Limits:
    """Limits of the OpenIGTLink server; the largest message is `rastrainer.igtl`'s own limit.

    Attributes:
        clients: connections at once; one more takes the place of the oldest that has never sent a
            message, and is closed at once where all have.
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
        buffer_bytes: what is handed to the operating system ahead of a client that reads slowly.
        waiting_messages: messages, and
        waiting_bytes: bytes that may wait for a client; one more drops it.
        commands_at_once: commands of one client that the control loop is given at once.
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
