"""The contents COMMAND and RTS_COMMAND: a named request with a body, and the answer to it."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import ClassVar

from rastrainer.errors import InputError
from rastrainer.igtl.wire import decode_text, encode_text, pack_name, unpack_name

_COMMAND = struct.Struct(">I128sHI")


@dataclass(frozen=True)
class _NumberedText:
    """What a command and its answer share.

    Attributes:
        command_id: the asking side's own 32-bit number; the answer carries the same.
        name: the command's, at most 128 ASCII characters.
        body: arguments or results; ours are JSON objects.
    """

    command_id: int
    name: str
    body: str = ""

    def pack(self) -> bytes:
        """Return the content's bytes.

        Raises:
            InputError: an identifier beyond 32 bits, or a name that is not short ASCII.
        """
        if not 0 <= self.command_id < 2**32:
            raise InputError("The number of a command must fit 32 bits.")
        name = pack_name(self.name, 128, "The name of a command")
        encoding, body = encode_text(self.body)
        return _COMMAND.pack(self.command_id, name, encoding, len(body)) + body

    @classmethod
    def unpack(cls, data: bytes, keep_bytes: bool = False):
        """Return the command that `data` holds; `keep_bytes` as of `decode_text`.

        Raises:
            InputError: cut short, or not UTF-8.
        """
        if len(data) < _COMMAND.size:
            raise InputError(f"A COMMAND must have at least {_COMMAND.size} bytes.")
        command_id, name, _encoding, length = _COMMAND.unpack_from(data)
        if length > len(data) - _COMMAND.size:
            raise InputError("A COMMAND must be as long as it says.")
        body = data[_COMMAND.size : _COMMAND.size + length]
        return cls(command_id, unpack_name(name, keep_bytes), decode_text(body, keep_bytes))


@dataclass(frozen=True)
class Command(_NumberedText):
    """A request that gets lost nowhere: Slicer queues every one of them."""

    TYPE: ClassVar[str] = "COMMAND"


@dataclass(frozen=True)
class CommandReply(_NumberedText):
    """The answer to the command of the same number and name.

    Whether the command succeeded stands in the message's metadata: see `SUCCESS`.
    """

    TYPE: ClassVar[str] = "RTS_COMMAND"


STATUS_KEY = "Status"
ERROR_KEY = "ErrorMessage"
SUCCESS = "SUCCESS"
FAIL = "FAIL"
"""What an answer's metadata says, as Slicer reads it."""
