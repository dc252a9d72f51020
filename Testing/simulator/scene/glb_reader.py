"""Read a GLB without the program that wrote it: header, JSON, and where each node stands."""

import json
import struct

import numpy as np


class Glb:
    """A parsed GLB.

    Attributes:
        nodes: by name, as in the JSON.
    """

    def __init__(self, content: bytes):
        magic, version, length = struct.unpack_from("<4sII", content)
        assert (magic, version, length) == (b"glTF", 2, len(content))
        json_length, kind = struct.unpack_from("<I4s", content, 12)
        assert kind == b"JSON"
        self.json = json.loads(content[20 : 20 + json_length])
        self._binary = content[20 + json_length + 8 :]
        names = [node["name"] for node in self.json["nodes"]]
        assert len(set(names)) == len(names), "names are unique"
        self.nodes = dict(zip(names, self.json["nodes"], strict=True))

    def children(self, name: str) -> list[str]:
        """Return the names of a node's children."""
        return [self.json["nodes"][index]["name"] for index in self.nodes[name].get("children", [])]

    def parent(self, name: str) -> str | None:
        """Return the name of a node's parent."""
        return next((other for other in self.nodes if name in self.children(other)), None)

    def matrix(self, name: str) -> np.ndarray:
        """Return a node's own (4, 4) matrix."""
        return np.array(self.nodes[name].get("matrix", np.eye(4).ravel())).reshape(4, 4).T

    def primitives(self, name: str) -> list[tuple[np.ndarray, np.ndarray, np.ndarray, dict]]:
        """Return vertices, normals, triangles and material of what hangs at or below a node."""
        found = []
        mesh = self.nodes[name].get("mesh")
        for primitive in [] if mesh is None else self.json["meshes"][mesh]["primitives"]:
            attributes = primitive["attributes"]
            found.append(
                (
                    self._values(attributes["POSITION"]),
                    self._values(attributes["NORMAL"]),
                    self._values(primitive["indices"]).reshape(-1, 3),
                    self.json["materials"][primitive["material"]],
                )
            )
        for child in self.children(name):
            found.extend(self.primitives(child))
        return found

    def vertices(self, name: str) -> np.ndarray:
        """Return all vertices of a node, in its own frame."""
        return np.concatenate([vertices for vertices, *_ in self.primitives(name)])

    def _values(self, index: int) -> np.ndarray:
        accessor = self.json["accessors"][index]
        view = self.json["bufferViews"][accessor["bufferView"]]
        kind = {5123: "<u2", 5125: "<u4", 5126: "<f4"}[accessor["componentType"]]
        width = {"SCALAR": 1, "VEC3": 3}[accessor["type"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        count = accessor["count"] * width
        values = np.frombuffer(self._binary, kind, count, start)
        return values.reshape(-1, width) if width > 1 else values.astype(np.int64)
