"""Our bytes equal the bytes of pyigtl and fastcrc, independent implementations."""

import random

import fastcrc
import numpy as np
import pyigtl
import pytest

from rastrainer.igtl.content import Point, Points, String
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
