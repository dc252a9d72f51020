"""Content of malicious input files."""

import random
from collections.abc import Iterator

HOSTILE_JSON = {
    "empty": b"",
    "no JSON": b"{",
    "another kind": b'"text"',
    "nothing": b"null",
    "deep lists": b"[" * 200_000 + b"]" * 200_000,
    "deep objects": b'{"a":' * 100_000 + b"1" + b"}" * 100_000,
    "deeper than any of ours": b'{"a":' * 65 + b"1" + b"}" * 65,
    "NaN": b'{"formatVersion": NaN}',
    "infinite": b'{"formatVersion": Infinity}',
    "too large a number": b'{"formatVersion": 1e999}',
    "endless number": b'{"formatVersion": ' + b"9" * 50_000 + b"}",
    "two roots": b"{}{}",
    "not UTF-8": b'{"title": "\xff\xfe"}',
    "NUL": b'{"title": "\x00"}',
    "a class to make": b'{"__class__": "os.system", "py/object": "os.system", "!!python": 1}',
    "a million keys": b"{" + b",".join(b'"%d":1' % number for number in range(9_000)) + b"}",
}


def mutations(content: bytes, count: int, seed: int) -> Iterator[bytes]:
    """Yield `count` variations of a file: bytes changed, cut, doubled, and numbers made strange."""
    generator = random.Random(seed)
    strange = (b"NaN", b"1e999", b"-1", b"0", b"999999999999", b"", b"{}", b'"\\u0000"', b"true")
    for _ in range(count):
        data = bytearray(content)
        for _ in range(generator.randint(1, 4)):
            place = generator.randrange(len(data)) if data else 0
            kind = generator.randrange(5)
            if kind == 0 and data:
                data[place] = generator.randrange(256)
            elif kind == 1:
                del data[place : place + generator.randint(1, 40)]
            elif kind == 2:
                data[place:place] = data[place : place + generator.randint(1, 200)]
            elif kind == 3:
                data[place : place + generator.randint(0, 6)] = generator.choice(strange)
            else:
                del data[place:]
        yield bytes(data)
