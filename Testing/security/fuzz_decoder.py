"""Search for bytes that break the decoder, guided by the branches that they reach (atheris).

    python -m Testing.security.fuzz_decoder -atheris_runs=1000000 -seed=1 FOLDER

`FOLDER` keeps the inputs that reached something new. Any exception ends it with status 77.
"""

import contextlib
import struct
import sys
from pathlib import Path

try:
    import atheris
except ImportError:
    sys.exit("Install atheris to search by coverage (Linux, Python 3.11 or newer): make soak does.")

with atheris.instrument_imports(include=["rastrainer.igtl", "rastrainer.protocol"]):
    from rastrainer.commands import check_arguments, decode_json_object
    from rastrainer.errors import InputError
    from rastrainer.igtl.content import Command
    from rastrainer.igtl.message import CONTENTS, HEADER_BYTES, MessageReader, pack, plain_crc64

from Testing.security.mutated_messages import valid_messages

TYPES = sorted(CONTENTS)


def read(data: bytes) -> None:
    """Read a stream of bytes as a connection does, and do with commands what the server does."""
    reader = MessageReader()
    messages = []
    half = len(data) // 2
    for piece in (data[:half], data[half:]):
        messages += reader.feed(piece)
    assert len(reader._buffer) <= len(data)
    for message in messages:
        with contextlib.suppress(InputError):  # A name that may come may not be sent.
            pack(message)
        if type(message.content) is Command:
            with contextlib.suppress(InputError):
                check_arguments(message.content.name, decode_json_object(message.content.body))


def read_as_peer(data: bytes) -> None:
    """Read `data` as it is, and as the body of a message whose header is right."""
    read(data)
    if len(data) > 2:
        kind, version, body = TYPES[data[0] % len(TYPES)], 1 + data[1] % 2, data[2:]
        header = struct.pack(
            ">H12s20sIIQQ", version, kind.encode(), b"Peer", 0, 0, len(body), plain_crc64(body)
        )
        read(header + body)


def main() -> None:
    """Search, beginning with the valid messages."""
    folders = [argument for argument in sys.argv[1:] if not argument.startswith("-")]
    if folders:
        for number, message in enumerate(valid_messages()):
            Path(folders[0], f"valid-{number}").write_bytes(message)
            content = bytes([number, number]) + message[HEADER_BYTES:]
            Path(folders[0], f"body-{number}").write_bytes(content)
    atheris.Setup(sys.argv, read_as_peer)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
