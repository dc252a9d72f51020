"""Write a volume as a file that Slicer reads."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from rastrainer.slicer.head.volume import Volume


def write_nrrd(path: Path, volume: Volume) -> Path:
    """Write a volume as an NRRD file of 16-bit integers and return its path."""
    # NRRD tells places as LPS here, as Slicer's own writer does.
    to_lps = np.diag([-1.0, -1.0, 1.0]) @ volume.ijk_to_ras[:3]
    directions = " ".join("({},{},{})".format(*to_lps[:, axis]) for axis in range(3))
    origin = "({},{},{})".format(*to_lps[:, 3])
    sizes = " ".join(map(str, volume.values.shape))
    header = (
        "NRRD0005\ntype: short\ndimension: 3\nspace: left-posterior-superior\n"
        f"sizes: {sizes}\nspace directions: {directions}\nspace origin: {origin}\n"
        "endian: little\nencoding: raw\n\n"
    )
    values = np.ascontiguousarray(volume.values.transpose(2, 1, 0)).round().astype("<i2")
    path.write_bytes(header.encode() + values.tobytes())
    return path
