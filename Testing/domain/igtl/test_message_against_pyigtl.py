"""Our bytes are those of pyigtl, an independent implementation, for every type that it has."""

from __future__ import annotations

import numpy as np
import pyigtl
import pytest

from rastrainer.igtl.content import String, Transform
from rastrainer.igtl.message import HEADER_BYTES, Message, pack, read_header, unpack
from rastrainer.igtl.points import Point, Points

MATRIX = np.array([[0, -1, 0, 10.5], [1, 0, 0, -20.25], [0, 0, 1, 300.125], [0, 0, 0, 1]])
TIME = 1234.5


def transform_pair():
    return Transform.from_matrix(MATRIX), pyigtl.TransformMessage(MATRIX, TIME, "Device")


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
def test_bytes_of_header_version_1_are_those_of_pyigtl(pair):
    content, peer = pair()
    assert pack(Message("Device", content, timestamp=TIME, version=1)) == peer.pack()


@PAIRS
def test_bytes_of_header_version_2_with_metadata_are_those_of_pyigtl(pair):
    content, peer = pair()
    peer.header_version, peer.message_id = 2, 42
    peer.metadata = {"seq": "12", "TransformStatus": "OK"}
    message = Message("Device", content, dict(peer.metadata), 42, TIME)
    assert pack(message) == peer.pack()


@PAIRS
def test_what_pyigtl_packed_is_read(pair):
    content, peer = pair()
    peer.header_version, peer.metadata = 2, {"seq": "12"}
    data = peer.pack()
    message = unpack(read_header(data), data[HEADER_BYTES:])
    assert message == Message("Device", content, {"seq": "12"}, 0, TIME, 2)
