"""Messages against the bytes of pyigtl and fastcrc, and messages that cannot be sent."""

from __future__ import annotations

import random
import struct
from dataclasses import replace

import fastcrc
import numpy as np
import pyigtl
import pytest

from rastrainer.errors import InputError
from rastrainer.igtl.content import Command, CommandReply, Point, Points, Status, String, Transform
from rastrainer.igtl.message import (
    HEADER_BYTES,
    Message,
    crc64,
    pack,
    plain_crc64,
    read_header,
    unpack,
)
from Testing.domain.igtl.sent_pose import transform_of

IDENTITY = Transform((1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0))
EVERY_CONTENT = [
    Transform((0, 1, 0, -1, 0, 0, 0, 0, 1, 10.5, -20.25, 300)),
    String("touch point 3"),
    String("é ± 1 mm"),
    Status(1, 7, "", "ready"),
    Points(()),
    Points((Point("1", (1, 2, 3)), Point("2", (4, 5, 6), (1, 2, 3, 4)))),
    Command(2**32 - 1, "StartTask", '{"task": "task-1"}'),
    CommandReply(5, "StartTask", "{}"),
]


def read(data: bytes) -> Message:
    header = read_header(data)
    body = data[HEADER_BYTES:]
    assert header.body_size == len(body)
    assert header.checksum == crc64(body)
    return unpack(header, body)


def test_command_has_its_number_a_name_of_128_bytes_the_encoding_and_the_length():
    data = pack(Message("command", Command(258, "Hello", "{}"), version=1))
    assert data[58:62] == b"\x00\x00\x01\x02"
    assert data[62:190] == b"Hello" + 123 * b"\0"
    assert data[190:] == b"\x00\x03\x00\x00\x00\x02{}"


def test_every_content_survives_packing_and_unpacking():
    for content in EVERY_CONTENT:
        sent = Message("Device", content, {"Status": "SUCCESS"})
        assert read(pack(sent)).content == content
        if content != Points(()):
            assert read(pack(replace(sent, metadata={}, version=1))).content == content


def test_longer_extended_header_is_skipped_by_its_size():
    content = String("ok").pack()
    body = struct.pack(">HHII", 16, 0, 0, 5) + b"new!" + content
    header = struct.pack(">H12s20sIIQQ", 2, b"STRING", b"S", 0, 0, len(body), crc64(body))
    assert read(header + body).content == String("ok")


@pytest.mark.parametrize(
    "message",
    [
        Message("A name of 21 letters.", IDENTITY),
        Message("Tête", IDENTITY),
        Message("Tip", IDENTITY, {"seq": "1"}, version=1),
        Message("Tip", IDENTITY, version=3),
        Message("Tip", IDENTITY, {"cut": "at\0NUL"}),
        Message("Tip", IDENTITY, {str(i): "" for i in range(257)}),
        Message("Text", String("x" * 65_536)),
        Message("Text", String("lone surrogate \ud800")),
        Message("Status", Status(1, name="a name of 21 letters.")),
        Message("command", Command(2**32, "Hello")),
        Message("command", Command(1, "Big", "x" * 2**24)),
    ],
)
def test_message_that_slicer_would_truncate_or_misread_is_refused(message):
    with pytest.raises(InputError):
        pack(message)


@pytest.mark.parametrize("bad", [float("nan"), float("inf"), -float("inf"), 1e39])
def test_number_beyond_32_bits_is_refused(bad):
    with pytest.raises(InputError, match="finite 32-bit"):
        Transform((bad, *IDENTITY.columns[1:]))
    with pytest.raises(InputError, match="finite 32-bit"):
        Point("1", (0, bad, 0))


def test_text_is_read_as_utf_8_whatever_encoding_is_announced():
    data = bytearray(String("é").pack())
    data[:2] = b"\x00\x01"
    assert String.unpack(bytes(data)) == String("é")


MATRIX = np.array([[0, -1, 0, 10.5], [1, 0, 0, -20.25], [0, 0, 1, 300.125], [0, 0, 0, 1]])
TIME = 1234.5


def transform_pair():
    return transform_of(MATRIX), pyigtl.TransformMessage(MATRIX, TIME, "Device")


def string_pair():
    return String("touch point 3"), pyigtl.StringMessage("touch point 3", TIME, "Device")


def points_pair():
    positions = [[1.5, 2, 3], [-4, 5, 6.25]]
    points = Points(tuple(Point(str(i + 1), tuple(xyz)) for i, xyz in enumerate(positions)))
    return points, pyigtl.PointMessage(
        positions, names=["1", "2"], timestamp=TIME, device_name="Device"
    )


PAIRS = pytest.mark.parametrize("pair", [transform_pair, string_pair, points_pair])


@PAIRS
def test_bytes_of_both_header_versions_are_those_of_pyigtl(pair):
    content, peer = pair()
    assert pack(Message("Device", content, timestamp=TIME, version=1)) == peer.pack()
    peer.header_version = 2
    peer.metadata = {"seq": "12", "TransformStatus": "OK"}
    message = Message("Device", content, dict(peer.metadata), TIME)
    assert pack(message) == peer.pack()


@PAIRS
def test_messages_packed_by_pyigtl_are_read(pair):
    content, peer = pair()
    peer.header_version, peer.metadata = 2, {"seq": "12"}
    data = peer.pack()
    message = unpack(read_header(data), data[HEADER_BYTES:])
    assert message == Message("Device", content, {"seq": "12"}, TIME, 2)


@pytest.mark.parametrize("checksum", [crc64, plain_crc64])
def test_checksum_gives_the_check_value_of_crc_64_ecma_182(checksum):
    assert checksum(b"123456789") == 0x6C40DF5F0B497347


def test_plain_python_equals_fastcrc_on_random_bodies():
    generator = random.Random(1)
    for length in [0, 1, 2, 7, 8, 9, 48, 255, 2098, 65_537]:
        body = generator.randbytes(length)
        assert plain_crc64(body) == fastcrc.crc64.ecma_182(body)
    assert crc64 is fastcrc.crc64.ecma_182
