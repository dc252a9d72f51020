"""Content of malicious input files."""

import json
import random
import struct
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

HOSTILE_XML = {
    "empty": b"",
    "no XML": b"robot",
    "not closed": b"<robot name='a'>",
    "entities that expand": b"<!DOCTYPE robot [<!ENTITY a 'aaaaaaaaaa'>"
    + b"".join(b"<!ENTITY %c '%s'>" % (98 + n, b"&%c;" % (97 + n) * 10) for n in range(9))
    + b"]><robot name='&j;'/>",
    "an entity of a file": b"<!DOCTYPE robot [<!ENTITY a SYSTEM 'file:///etc/passwd'>]>"
    b"<robot name='a'><link name='b'/>&a;</robot>",
    "a document type elsewhere": b"<!DOCTYPE robot SYSTEM 'http://127.0.0.1:9/x.dtd'><robot/>",
    # Read as UTF-7 this is another document: a document type stands where a comment was.
    "another encoding": b"<?xml version='1.0' encoding='UTF-7'?><!-- +AC0ALQA+ +ADwAIQ-DOCTYPE "
    b"robot +AFsAPAAh-ENTITY a 'b'+AD4AXQA+ +ADwAIQAtAC0 --><robot name='a'/>",
    "UTF-16": "<?xml version='1.0' encoding='UTF-16'?><robot name='a'/>".encode("utf-16"),
    "deep": b"<robot name='a'>" + b"<link>" * 100_000,
    "many": b"<robot name='a'>" + b"<link/>" * 100_000 + b"</robot>",
    "NUL": b"<robot name='\x00'/>",
    "NaN": b"<robot name='a'><link name='b'/><link name='c'/><joint name='d' type='revolute'>"
    b"<parent link='b'/><child link='c'/><origin xyz='nan inf 0'/></joint></robot>",
}


def glb(tree: dict) -> bytes:
    """Return a GLB file without data."""
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    chunk = struct.pack("<II", len(text), 0x4E4F534A) + text
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunk)) + chunk


def _one_mesh(count: object, nodes: list[dict], kind: str = "VEC3") -> dict:
    """Return a glTF tree whose accessors name no data: they are zeros, as many as they claim."""
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": nodes,
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"componentType": 5126, "count": count, "type": kind},
            {"componentType": 5125, "count": count, "type": "SCALAR"},
        ],
    }


HOSTILE_GLB = {
    "a billion vertices in 400 bytes": glb(_one_mesh(10**9, [{"mesh": 0}])),
    "a thousand copies": glb(
        _one_mesh(500_000, [{"children": list(range(1, 900))}, *[{"mesh": 0}] * 899])
    ),
    "copies of copies": glb(
        _one_mesh(3, [{"children": [1] * 1000}, {"children": [2] * 1000}, {"mesh": 0}])
    ),
    "many nodes": glb(_one_mesh(3, [{"mesh": 0}] * 100_000)),
    "its own child": glb(_one_mesh(3, [{"mesh": 0, "children": [0, 0]}])),
    "less than nothing": glb(_one_mesh(-1, [{"mesh": 0}])),
    "half a vertex": glb(_one_mesh(0.5, [{"mesh": 0}])),
    "another kind": glb(_one_mesh(3, [{"mesh": 0}], "VEC99")),
    "no such mesh": glb(_one_mesh(3, [{"mesh": 7}])),
    "deep": glb({})[:20] + b"[" * 100_000,
    "no glTF": b"glTF" + bytes(100),
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
