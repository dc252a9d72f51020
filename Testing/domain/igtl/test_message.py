"""Messages against bytes computed by hand, and messages that cannot be sent."""

from __future__ import annotations

import struct
from dataclasses import replace

import pytest

from rastrainer.errors import InputError
from rastrainer.igtl.content import Command, CommandReply, Point, Points, Status, String, Transform
from rastrainer.igtl.message import HEADER_BYTES, Message, crc64, pack, read_header, unpack

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


def test_transform_of_header_version_1_has_the_bytes_worked_out_by_hand():
    transform = Transform((1, 4, 7, 2, 5, 8, 3, 6, 9, 10, 20, 30))
    data = pack(Message("Tip", transform, timestamp=2.5, version=1))
    assert data[:2] == b"\x00\x01"
    assert data[2:14] == b"TRANSFORM\0\0\0"
    assert data[14:34] == b"Tip" + 17 * b"\0"
    assert data[34:42] == b"\x00\x00\x00\x02\x80\x00\x00\x00"
    assert data[42:50] == b"\x00\x00\x00\x00\x00\x00\x00\x30"
    floats = "3f800000 40800000 40e00000 40000000 40a00000 41000000"
    floats += "40400000 40c00000 41100000 41200000 41a00000 41f00000"
    assert data[58:] == bytes.fromhex(floats)


def test_string_of_header_version_2_with_metadata_has_the_bytes_worked_out_by_hand():
    data = pack(Message("State", String("ok"), {"k": "vv"}, timestamp=0))
    extended = "000c 000a 00000003 00000000"
    content = "0003 0002 6f6b"
    metadata = "0001 0001 0003 00000002 6b 7676"
    assert data[58:] == bytes.fromhex(extended + content + metadata)
    assert data[:2] == b"\x00\x02"


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


def test_metadata_time_and_version_survive_packing_and_unpacking():
    sent = Message("Tip", IDENTITY, {"seq": "12", "note": "3 ± 1"}, 1234.5, 2)
    assert read(pack(sent)) == sent


def test_longer_extended_header_is_skipped_by_its_size():
    content = String("ok").pack()
    body = struct.pack(">HHII", 16, 0, 0, 5) + b"new!" + content
    header = struct.pack(">H12s20sIIQQ", 2, b"STRING", b"S", 0, 0, len(body), crc64(body))
    assert read(header + body).content == String("ok")


def test_a_transform_keeps_rows_and_columns_apart():
    transform = Transform((1, 4, 7, 2, 5, 8, 3, 6, 9, 10, 20, 30))
    assert transform.matrix == ((1, 2, 3, 10), (4, 5, 6, 20), (7, 8, 9, 30), (0, 0, 0, 1))


@pytest.mark.parametrize(
    "message",
    [
        Message("A name of 21 letters.", IDENTITY),
        Message("", IDENTITY),
        Message("Tête", IDENTITY),
        Message("a\nb", IDENTITY),
        Message("Points", Points(())),
        Message("Points", Points(()), {"count": "0"}, version=1),
        Message("Points", Points(()), version=1),
        Message("Tip", IDENTITY, {"seq": "1"}, version=1),
        Message("Tip", IDENTITY, version=3),
        Message("Tip", IDENTITY, {"é": "1"}),
        Message("Tip", IDENTITY, {"cut": "at\0NUL"}),
        Message("Tip", IDENTITY, timestamp=-1),
        Message("Tip", IDENTITY, {str(i): "" for i in range(257)}),
        Message("Text", String("x" * 65_536)),
        Message("Text", String("cut at\0NUL")),
        Message("Text", String("lone surrogate \ud800")),
        Message("Status", Status(1, name="a name of 21 letters.")),
        Message("Status", Status(70_000)),
        Message("Points", Points((Point("x" * 65, (0, 0, 0)),))),
        Message("command", Command(2**32, "Hello")),
        Message("command", Command(1, "H" * 129)),
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


@pytest.mark.parametrize(
    ("kind", "data"),
    [
        (Transform, bytes(47)),
        (Transform, bytes(52)),
        (Transform, struct.pack(">12f", *[float("nan")] * 12)),
        (String, b"\x00\x03\x00"),
        (String, b"\x00\x03\x00\x05four"),
        (String, b"\x00\x03\x00\x02\xff\xfe"),
        (Points, bytes(135)),
        (Points, bytes(137)),
        (Points, b"\0" * 100 + struct.pack(">4f", 0, float("inf"), 0, 0) + b"\0" * 20),
        (Status, bytes(29)),
        (Command, bytes(137)),
        (Command, struct.pack(">I128sHI", 1, b"Hello", 3, 2**32 - 1) + b"{}"),
        (CommandReply, b""),
    ],
)
def test_truncated_or_not_finite_content_is_refused_with_a_message(kind, data):
    with pytest.raises(InputError, match=r"must .*\."):
        kind.unpack(data)


@pytest.mark.parametrize(
    "sizes",
    [(11, 0, 0), (200, 0, 0), (12, 60, 0), (12, 0, 2**32 - 1), (12, 1, 0), (12, 65_535, 65_535)],
)
def test_extended_header_whose_sizes_do_not_fit_is_refused(sizes):
    body = struct.pack(">HHII", *sizes, 0) + IDENTITY.pack()
    header = struct.pack(">H12s20sIIQQ", 2, b"TRANSFORM", b"T", 0, 0, len(body), crc64(body))
    with pytest.raises(InputError):
        unpack(read_header(header), body)


@pytest.mark.parametrize(
    "index",
    [
        struct.pack(">H", 1),
        struct.pack(">H", 65_535) + bytes(64),
        struct.pack(">HHHI", 1, 3, 3, 2**32 - 1),
        struct.pack(">HHHI", 1, 65_535, 3, 1),
    ],
)
def test_metadata_longer_than_the_message_is_refused(index):
    body = struct.pack(">HHII", 12, len(index), 2, 0) + IDENTITY.pack() + index + b"kv"
    header = struct.pack(">H12s20sIIQQ", 2, b"TRANSFORM", b"T", 0, 0, len(body), crc64(body))
    with pytest.raises(InputError):
        unpack(read_header(header), body)
