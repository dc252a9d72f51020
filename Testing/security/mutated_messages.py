"""OpenIGTLink messages that are not quite valid, drawn from a seed."""

import json
import random
import struct
from collections.abc import Callable

from rastrainer.igtl.content import Command, CommandReply, Point, Points, Status, String, Transform
from rastrainer.igtl.message import HEADER_BYTES, Message, crc64, pack
from Testing.security.hostile_content import HOSTILE_JSON

TRIAL = "6b8f2f1e-6a60-4c0e-9a37-111111111111"
_REGISTRATION = {
    "trialId": TRIAL,
    "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1],
    "freMm": 1.0,
    "expectedTreMm": 1.5,
}
COMMANDS = {
    "Hello": {"protocolVersion": 1, "client": "somebody", "toolTipHz": 60, "linksHz": 30},
    "ListTasks": {},
    "LoadScenario": {"folder": "nowhere"},
    "StartTutorial": {"trainee": "P01", "mode": "desktop"},
    "StartDrill": {"trainee": "P01", "mode": "desktop"},
    "StartTask": {"task": "task-1", "trainee": "P01", "mode": "desktop", "seed": 4},
    "Jog": {"velocityMmS": [10, -20, 30], "frame": "world", "durationS": 0.1},
    "MoveTipTo": {"positionMm": [500, 0, 400], "speedMmS": 100},
    "Capture": {},
    "Trace": {"on": True},
    "Undo": {},
    "Register": {},
    "UseRegistration": _REGISTRATION,
    "AcceptRegistration": {},
    "RegisterAgain": {},
    "AlignGuide": {"standOffMm": 30},
    "LockGuide": {},
    "Feed": {"velocityMmS": 2.5, "durationS": 0.1},
    "RetractDrill": {},
    "StartInsertion": {},
    "ReleaseInstrument": {},
    "Abort": {},
    "Pause": {},
    "Resume": {},
    "SetCamera": {"camera": "far"},
    "SubmitRegistration": _REGISTRATION,
    "TrialScored": {"trialId": TRIAL, "score": 70, "details": {"version": "2"}},
    "PlanTarget": {"positionMm": [500, 0, 300], "entryMm": [500, 0, 400], "name": "target"},
    "StudyStep": {"trainee": "P01", "kind": "trial", "number": 2, "count": 9, "task": "task-1"},
    "Curriculum": {
        "trainee": "P01",
        "next": "one",
        "assignments": [
            {"name": "one", "task": "task-1", "goal": "score", "state": "open", "needed": 2}
        ],
    },
    "GetTrial": {"trialId": TRIAL},
    "GetJournal": {"trialId": TRIAL, "start": 0},
    "AcknowledgeTrial": {"trialId": TRIAL},
}
TYPES = (
    *(b"TRANSFORM", b"STRING", b"POINT", b"STATUS", b"COMMAND", b"RTS_COMMAND"),
    *(b"IMAGE", b"POLYDATA", b"GET_STATUS", b"STT_TDATA", b"STP_TDATA", b"RTS_STATUS"),
    *(b"CAPABILITY", b"NDARRAY", b"QTDATA", b"TDATA", b"BIND", b"X_Y", b"\xff\xff", b""),
)
SIZES = (0, 1, 2, 11, 12, 13, 48, 2**16 - 1, 2**16, 72 * 1024 + 1, 2**20, 2**24)
FATAL_SIZES = (2**24 + 1, 2**31 - 1, 2**31, 2**32, 2**63, 2**64 - 1)
NUMBERS = (0, -1, 1e308, -1e308, 1e-300, 2**63, 10**30, True, None, "1", [], [1, 2], {}, "x" * 70)


def valid_messages() -> list[bytes]:
    """Return one of each type and command, with either header version."""
    contents = [
        ("Probe", Transform((1, 0, 0, 0, 1, 0, 0, 0, 1, 10, 20, 30))),
        ("ToolTipToWorld", Transform((1, 0, 0, 0, 1, 0, 0, 0, 1, 10, 20, 30))),
        ("Note", String('{"phase": "idle"}')),
        ("Note", String("é ± 1 mm")),
        ("Points", Points(tuple(Point(str(i), (i, 0, 0)) for i in range(15)))),
        ("Device", Status(1, 2, "none", "well")),
        ("command", CommandReply(3, "TrialCompleted", "{}")),
        *(
            ("command", Command(number, name, json.dumps(arguments)))
            for number, (name, arguments) in enumerate(COMMANDS.items(), start=1)
        ),
    ]
    metadata = {"seq": "1", "note": "ö", "Status": "SUCCESS"}
    return [
        pack(Message(device, content, metadata if version == 2 else {}, 1.0, version))
        for device, content in contents
        for version in (1, 2)
    ]


class MutatedMessages:
    """An endless stream of messages by a seed; `mutated` counts the invalid messages."""

    def __init__(self, seed: int) -> None:
        self.mutated = 0
        self._random = random.Random(seed)
        self._valid = valid_messages()
        self._bodies = [json.dumps(arguments) for arguments in COMMANDS.values()]
        self._bodies += [body.decode("latin-1")[:60_000] for body in HOSTILE_JSON.values()]
        self._mutations: tuple[Callable[[bytearray], bytes], ...] = (
            bytes,
            self._with_bits_flipped,
            self._with_bytes_changed,
            self._cut,
            self._with_a_false_size,
            self._with_another_type,
            self._with_another_body,
            self._spliced,
            self._with_a_bad_body,
            self._with_a_bad_body,
            self._with_a_wrong_checksum,
            self._with_other_arguments,
            self._with_other_arguments,
            self._garbage,
        )

    def first(self) -> bytes:
        """Return a good message, with which a connection may begin."""
        return self._random.choice(self._valid)

    def next(self) -> bytes:
        """Return the next message."""
        mutate = self._random.choice(self._mutations)
        message = mutate(bytearray(self._random.choice(self._valid)))
        self.mutated += message not in self._valid
        return message

    def fatal(self) -> bytes:
        """Return a message that must end its connection."""
        data = bytearray(self._random.choice(self._valid))
        data[42:50] = struct.pack(">Q", self._random.choice(FATAL_SIZES))
        return bytes(data)

    def _with_bits_flipped(self, data: bytearray) -> bytes:
        for _ in range(self._random.randint(1, 8)):
            data[self._random.randrange(len(data))] ^= 1 << self._random.randrange(8)
        return bytes(data)

    def _with_bytes_changed(self, data: bytearray) -> bytes:
        for _ in range(self._random.randint(1, 5)):
            value = self._random.choice([0, 1, 0x7F, 0x80, 0xFF, self._random.randrange(256)])
            data[self._random.randrange(len(data))] = value
        return bytes(data)

    def _cut(self, data: bytearray) -> bytes:
        return bytes(data[: self._random.randrange(1, len(data))])

    def _with_a_false_size(self, data: bytearray) -> bytes:
        near = len(data) - HEADER_BYTES + self._random.randint(-3, 3)
        size = self._random.choice((*SIZES, max(0, near), max(0, near), max(0, near)))
        data[42:50] = struct.pack(">Q", size)
        return bytes(data)

    def _with_another_type(self, data: bytearray) -> bytes:
        data[2:14] = self._random.choice(TYPES).ljust(12, b"\0")
        return bytes(data)

    def _with_another_body(self, data: bytearray) -> bytes:
        body = self._random.choice(self._valid)[HEADER_BYTES:]
        return _sealed(data[:HEADER_BYTES], body)

    def _spliced(self, data: bytearray) -> bytes:
        body, other = data[HEADER_BYTES:], self._random.choice(self._valid)[HEADER_BYTES:]
        cut = self._random.randrange(len(body) + 1)
        return _sealed(data[:HEADER_BYTES], bytes(body[:cut]) + other[cut // 2 :])

    def _with_a_bad_body(self, data: bytearray) -> bytes:
        """Change the content of the body, with the right checksum."""
        body = data[HEADER_BYTES:]
        for _ in range(self._random.randint(1, 6)):
            # The sizes are at the beginning; they are worth more tries than the rest.
            reach = self._random.choice([min(16, len(body)), len(body)])
            body[self._random.randrange(reach)] = self._random.choice(
                [0, 1, 2, 12, 0x7F, 0xFF, self._random.randrange(256)]
            )
        if self._random.random() < 0.2:
            del body[self._random.randrange(len(body)) :]
        return _sealed(data[:HEADER_BYTES], bytes(body))

    def _with_a_wrong_checksum(self, data: bytearray) -> bytes:
        data[50 + self._random.randrange(8)] ^= 1 << self._random.randrange(8)
        return bytes(data)

    def _with_other_arguments(self, _data: bytearray) -> bytes:
        """Return a command, intact on the wire, with wrong arguments."""
        name = self._random.choice(list(COMMANDS))
        arguments = dict(COMMANDS[name])
        if arguments and self._random.random() < 0.8:
            chosen = self._random.choice(list(arguments))
            arguments[chosen] = self._random.choice(NUMBERS)
            body = json.dumps(arguments)
        else:
            body = self._random.choice(self._bodies)
        number = self._random.randrange(2**32)
        packed = body.encode("latin-1", "replace")
        content = struct.pack(">I128sHI", number, name.encode(), 3, len(packed)) + packed
        header = struct.pack(">H12s20sIIQQ", 1, b"COMMAND", b"command", 0, 0, 0, 0)
        return _sealed(bytearray(header), content)

    def _garbage(self, _data: bytearray) -> bytes:
        return self._random.randbytes(self._random.randint(1, 200))


def _sealed(header: bytearray, body: bytes) -> bytes:
    """Return a message whose header has the true size and checksum of its body."""
    header[42:58] = struct.pack(">QQ", len(body), crc64(body))
    return bytes(header) + body
