"""Nothing that would crash or upset 3D Slicer can be sent: all that is sent passes one gate."""

import ast
import struct
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import pytest
from hypothesis import given
from hypothesis import strategies as some

from rastrainer.errors import InputError
from rastrainer.igtl.content import Command, CommandReply, Point, Points, Status, String, Transform
from rastrainer.igtl.message import Message, pack
from rastrainer_simulator.net.igtl.outgoing import Outgoing, OutgoingQueue
from Testing.security.wire_checker import SENT_TYPES, OffenseError, WireChecker

SIMULATOR = Path(__file__).parents[2] / "RASTrainerSimulatorServer/rastrainer_simulator"
LINK = SIMULATOR / "net" / "igtl"
SENDING = ("sendall", "sendto", "sock_sendall", "writelines", "create_connection")
# Any text and any number, with edge cases: the calling code may be wrong in every way.
NUMBERS = some.floats(width=64) | some.sampled_from([3.4e38, 3.5e38, 1e308])
TEXTS = some.text(max_size=300) | some.sampled_from(["", "\0", "x" * 65_535, "x" * 65_536])
NAMES = some.text(max_size=70) | some.sampled_from(["command", "x" * 20, "x" * 21, "", " "])
POINTS = some.tuples(NAMES, some.tuples(NUMBERS, NUMBERS, NUMBERS))
MAKERS = (
    some.tuples(some.just(Transform), some.tuples(some.tuples(*[NUMBERS] * 12))),
    some.tuples(some.just(String), some.tuples(TEXTS)),
    some.tuples(
        some.just(Status), some.tuples(some.integers(-1, 2**16), some.integers(), NAMES, TEXTS)
    ),
    some.tuples(some.just(Command), some.tuples(some.integers(-1, 2**33), NAMES, TEXTS)),
    some.tuples(some.just(CommandReply), some.tuples(some.integers(-1, 2**33), NAMES, TEXTS)),
    some.tuples(some.just(Points), some.tuples(some.lists(POINTS, max_size=20))),
)


def content_of(kind, arguments):
    if kind is Points:
        return Points(tuple(Point(*point) for point in arguments[0]))
    return kind(*arguments)


@given(
    some.one_of(*MAKERS),
    NAMES,
    some.dictionaries(NAMES, TEXTS, max_size=3) | some.just({"Status": "SUCCESS"}),
    some.sampled_from([1, 2, 2, 2, 0, 3]),
    some.none() | NUMBERS,
)
def test_what_the_gate_lets_through_never_harms_slicer(made, device, metadata, version, timestamp):
    kind, arguments = made
    police = WireChecker()
    try:
        content = content_of(kind, arguments)
        message = Message(device, content, metadata, timestamp, version)
        packed = [Outgoing(message).packed(header_version) for header_version in (1, 2)]
    except InputError:
        return
    for data in packed:
        if data is None:
            continue
        police.feed(data)
        assert police._buffer == b""


@dataclass(frozen=True)
class Invented:
    """A content whose type has a prefix, such as those that crash Slicer."""

    TYPE: ClassVar[str] = "GET_STATUS"

    def pack(self) -> bytes:
        return b"x"


class Disguised(Transform):
    TYPE = "STT_TDATA"


@pytest.mark.parametrize(
    "content", [Invented(), Disguised((0.0,) * 12), None, b"raw", Transform], ids=repr
)
def test_a_foreign_type_cannot_be_sent(content):
    with pytest.raises(InputError, match="must be one of"):
        pack(Message("Device", content))


@pytest.mark.parametrize(
    ("harm", "data"),
    [
        ("type", struct.pack(">H12s20sIIQQ", 2, b"GET_STATUS", b"D", 0, 0, 0, 0)),
        ("body of 2147483648", struct.pack(">H12s20sIIQQ", 1, b"STRING", b"D", 0, 0, 2**31, 0)),
        ("checksum", struct.pack(">H12s20sIIQQ", 1, b"STRING", b"D", 0, 0, 4, 1) + bytes(4)),
        (
            "would not clear",
            struct.pack(">H12s20sIIQQ", 2, b"POINT", b"D", 0, 0, 12, 0x0)
            + struct.pack(">HHII", 12, 0, 0, 0),
        ),
    ],
)
def test_the_wire_check_of_these_tests_detects_what_would_harm_slicer(harm, data, monkeypatch):
    if harm == "would not clear":
        monkeypatch.setattr("Testing.security.wire_checker._crc64", lambda _body: 0)
    with pytest.raises(OffenseError, match=harm):
        WireChecker().feed(data)


def test_every_message_type_the_gate_allows_is_one_that_slicer_accepts():
    from rastrainer.igtl.message import CONTENTS

    assert {kind.encode() for kind in CONTENTS} == SENT_TYPES


def calls_in(path):
    """Give the name and the node of each call in a file."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call):
            yield getattr(node.func, "attr", getattr(node.func, "id", "")), node


def test_bytes_reach_a_client_in_one_place_and_only_through_the_gate():
    writes, queued, packs = [], [], []
    gate = next(
        node
        for node in ast.walk(ast.parse((LINK / "outgoing.py").read_text(encoding="utf-8")))
        if isinstance(node, ast.ClassDef) and node.name == Outgoing.__name__
    )
    for path in sorted(LINK.glob("*.py")):
        for name, call in calls_in(path):
            if name in ("write", "writelines", "sendall", "sendto", "sock_sendall"):
                writes.append((path.name, ast.unparse(call.args[0])))
            if name in ("put", "put_latest"):
                queued.append((path.name, ast.unparse(call.args[-1])))
            # A content by itself is packed to be compared, and goes nowhere.
            if name == "pack" and ast.unparse(call) != "message.content.pack()":
                packs.append((path.name, call.lineno))
    assert writes == [("server.py", "self._queue.take(BUFFER_BYTES)")]
    assert set(queued) == {("server.py", "data")}
    assert {name for name, _line in packs} == {"outgoing.py"}
    assert all(gate.lineno < line <= gate.end_lineno for _name, line in packs)


def test_no_other_part_of_the_simulator_packs_messages_or_writes_to_sockets():
    packing, sending = set(), set()
    for path in SIMULATOR.rglob("*.py"):
        text, place = path.read_text(encoding="utf-8"), path.relative_to(SIMULATOR).as_posix()
        if not any(word in text for word in (*SENDING, "rastrainer.igtl.message")):
            continue
        sending |= {(place, name) for name, _call in calls_in(path) if name in SENDING}
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.ImportFrom) and node.module == "rastrainer.igtl.message":
                packing |= {place for alias in node.names if alias.name == "pack"}
    assert packing == {"net/igtl/outgoing.py"}
    assert sending == {("net/igtl/server.py", "create_connection")}


def test_the_queue_returns_only_whole_messages():
    queue, police = OutgoingQueue(), WireChecker()
    for number in range(50):
        data = Outgoing(Message("Text", String("x" * 100 * number), {"n": "1"})).packed(2)
        queue.put(data) if number % 2 else queue.put_latest(("STRING", str(number)), data)
    while queue:
        police.feed(queue.take(3_000))
        assert police._buffer == b""
    assert police.seen == {b"STRING": 50}
