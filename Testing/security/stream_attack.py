"""Views that send invalid messages: mutated text in mutated WebSocket frames."""

import json
import random
import socket
import struct
from contextlib import suppress

from Testing.security.hostile_content import HOSTILE_JSON, mutations

HOST = "127.0.0.1"
SUBPROTOCOL = "rastrainer.views.1"
TIMEOUT_S = 120.0
TEXT, BINARY, CLOSE, PING, PONG = 1, 2, 8, 9, 10

HELLO = {"type": "hello", "kind": "headset", "device": "", "refreshHz": 60}
POSE = [0.5, 0.0, 1.2, 0.5, 0.5, 0.5, 0.5]
MESSAGES = (
    HELLO,
    {"type": "key", "code": "KeyW", "isDown": True, "text": "w"},
    {"type": "layout", "keys": {"KeyW": "z"}},
    {"type": "pad", "axes": [0.0, 0.5, 0, 0], "buttons": [0] * 17},
    {"type": "sticks", "translation": [0, 1, 0], "rotation": [0, 0], "fine": False, "yawDeg": 0},
    {"type": "orbit", "aroundDeg": 10, "higherDeg": -5, "zoom": 1.1},
    {"type": "press", "control": "menu"},
    {"type": "item", "name": "train"},
    {"type": "text", "name": "trainee", "value": "P01"},
    {"type": "picture", "task": "task-1", "share": 0.5},
    {"type": "frames", "shown": 60, "dropped": 0, "refreshHz": 60},
    {"type": "visibility", "isVisible": True},
    {"type": "headsetPose", "eyes": POSE, "left": None, "right": POSE},
    {"type": "alive"},
)
"""One of each type; the first is the hello."""


def frame(kind: int, payload: bytes, is_last: bool = True, is_masked: bool = True) -> bytes:
    """Return a WebSocket frame; the mask is zero, which changes no byte."""
    size = len(payload)
    first = bytes([(0x80 if is_last else 0) | kind])
    mask = 0x80 if is_masked else 0
    if size < 126:
        length = bytes([mask | size])
    elif size < 2**16:
        length = bytes([mask | 126]) + struct.pack(">H", size)
    else:
        length = bytes([mask | 127]) + struct.pack(">Q", size)
    return first + length + (bytes(4) if is_masked else b"") + payload


class StreamAttack:
    """Sends damaged messages to the stream of a view server, one view after the other.

    Attributes:
        mutated: damaged messages sent, one a view, each after some good messages.
        closed: views that the server has closed.
    """

    def __init__(self, port: int, key: str, seed: int) -> None:
        self._port = port
        self._key = key
        self._random = random.Random(seed)
        self._good = [json.dumps(message).encode() for message in MESSAGES]
        self.mutated = self.closed = 0

    def run(self, count: int) -> None:
        """Send damaged messages, each from a separate view, which many of them end."""
        for _ in range(count):
            with socket.create_connection((HOST, self._port), TIMEOUT_S) as peer:
                self._join(peer)
                with suppress(OSError):  # The other side has ended it.
                    while self._random.random() < 0.7:
                        peer.sendall(frame(TEXT, self._random.choice(self._good[1:])))
                    peer.sendall(self._bad())
                    peer.shutdown(socket.SHUT_WR)
                self.mutated += 1
                self._read_to_the_end(peer)

    def _join(self, peer: socket.socket) -> None:
        lines = (
            "GET /stream HTTP/1.1",
            f"Host: {HOST}:{self._port}",
            "Connection: Upgrade",
            "Upgrade: websocket",
            "Sec-WebSocket-Version: 13",
            "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==",
            f"Sec-WebSocket-Protocol: {SUBPROTOCOL}",
            f"Authorization: Bearer {self._key}",
        )
        peer.sendall("\r\n".join((*lines, "", "")).encode())
        answer = b""
        while b"\r\n\r\n" not in answer:
            piece = peer.recv(1)
            assert piece, "the stream was refused"
            answer += piece
        assert answer.startswith(b"HTTP/1.1 101"), answer
        if self._random.random() < 0.9:
            peer.sendall(frame(TEXT, self._good[0]))

    def _bad(self) -> bytes:
        """Return one frame or several, most often with an error."""
        good = self._random.choice(self._good)
        kind = self._random.randrange(8)
        if kind < 3:
            return frame(TEXT, next(mutations(good, 1, self._random.random())))
        if kind == 3:
            content = self._random.choice(list(HOSTILE_JSON.values()))
            return frame(TEXT, content[: self._random.choice([100, 16_000, 10**6])])
        if kind == 4:
            return frame(self._random.randrange(16), good, self._random.random() < 0.7)
        if kind == 5:
            pieces = [frame(0 if number else TEXT, good, False) for number in range(300)]
            return b"".join(pieces)
        if kind == 6:
            return b"".join(frame(PING, good[:100]) for _ in range(50)) + frame(BINARY, good)
        damaged = bytearray(frame(TEXT, good, is_masked=self._random.random() < 0.8))
        for _ in range(3):
            damaged[self._random.randrange(min(14, len(damaged)))] = self._random.randrange(256)
        return bytes(damaged)

    def _read_to_the_end(self, peer: socket.socket) -> None:
        with suppress(ConnectionError):
            while peer.recv(65_536):
                pass
        self.closed += 1
