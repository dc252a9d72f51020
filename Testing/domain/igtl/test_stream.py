"""The stream reader returns complete messages from any pieces, and nothing from other bytes."""

from __future__ import annotations

import random
import struct

import pytest

from rastrainer.igtl.content import Command, String, Transform
from rastrainer.igtl.message import (
    MAX_BODY_BYTES,
    MAX_GARBAGE_BYTES,
    MAX_KEPT_BYTES,
    Message,
    MessageReader,
    StreamError,
    pack,
)

TIP = Message("Tip", Transform((1, 0, 0, 0, 1, 0, 0, 0, 1, 5, 6, 7)), {"seq": "1"}, timestamp=1)
STATE = Message("SimState", String('{"phase": "idle"}'), timestamp=1)
CALL = Message("command", Command(3, "Hello", "{}"), timestamp=1, version=1)
GOOD = [TIP, STATE, CALL]


def header(kind: bytes, size: int, version: int = 1, checksum: int = 0) -> bytes:
    return struct.pack(">H12s20sIIQQ", version, kind, b"Peer", 0, 0, size, checksum)


def with_wrong_checksum(message: Message) -> bytes:
    data = bytearray(pack(message))
    data[-1] ^= 1
    return bytes(data)


@pytest.fixture
def reader() -> MessageReader:
    return MessageReader()


@pytest.mark.parametrize("piece", [1, 2, 57, 58, 59, 1000])
def test_messages_are_reassembled_in_order_from_any_pieces(reader, piece):
    stream = b"".join(pack(message) for message in GOOD) * 3
    found = []
    for start in range(0, len(stream), piece):
        found += reader.feed(stream[start : start + piece])
    assert found == GOOD * 3
    assert reader.is_between_messages
    assert not reader.errors


def test_message_with_a_wrong_checksum_is_counted_and_skipped(reader):
    assert reader.feed(with_wrong_checksum(TIP) + pack(STATE)) == [STATE]
    assert reader.errors == {StreamError.CHECKSUM: 1}


def test_unsupported_and_too_long_messages_are_counted_and_skipped_without_buffering(reader):
    stream = header(b"IMAGE", 10 * 2**20) + bytes(10 * 2**20) + pack(TIP)
    found = []
    for start in range(0, len(stream), 65_536):
        found += reader.feed(stream[start : start + 65_536])
        assert len(reader._buffer) <= 65_536
    assert found == [TIP]
    size = MAX_KEPT_BYTES + 1
    assert reader.feed(header(b"STRING", size) + bytes(size) + pack(TIP)) == [TIP]
    assert reader.errors == {StreamError.TYPE: 1, StreamError.SIZE: 1}


@pytest.mark.parametrize("size", [MAX_BODY_BYTES + 1, 2**31, 2**64 - 1])
def test_claimed_body_above_16_mib_ends_the_stream(reader, size):
    assert reader.feed(header(b"TRANSFORM", size) + pack(TIP)) == []
    assert reader.refusal == "A message claims more than 16777216 bytes."
    assert reader.feed(pack(TIP)) == []


def test_reader_finds_the_next_message_after_garbage(reader):
    garbage = b"GET / HTTP/1.1\r\nHost: example\r\n\r\n" + bytes(100) + b"\0\1A\0\2Z"
    unknown = header(b"TRANSFORM", 48, version=3) + bytes(48)
    stream = pack(STATE) + garbage + pack(TIP) + unknown + pack(STATE)
    assert reader.feed(stream) == [STATE, TIP, STATE]
    assert reader.errors == {StreamError.GARBAGE: 2}


@pytest.mark.parametrize(
    "beginning",
    [b"POST / HTTP/1.1\r\nHost: a\r\n\r\n", b"\x16\x03\x01" + bytes(60), b"\0\3" + bytes(60)],
    ids=["HTTP", "TLS", "unknown version"],
)
def test_a_stream_that_does_not_begin_with_a_message_is_not_searched_for_one(reader, beginning):
    assert reader.feed(beginning + bytes(60)) == []
    assert reader.feed(pack(CALL)) == []
    assert reader.refusal == "It does not start with an OpenIGTLink message."


def test_endless_garbage_ends_the_stream_and_takes_no_memory(reader):
    generator = random.Random(2)
    assert reader.feed(pack(TIP)) == [TIP]
    for _ in range(MAX_GARBAGE_BYTES // 1000 + 2):
        reader.feed(bytes(generator.choices(range(65, 91), k=1000)))
        assert len(reader._buffer) < 2000
    assert reader.refusal
