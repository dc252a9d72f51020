"""Extract the default scenario's head from the Colin27 MRI of Debian's package mricron-data.

    python assets/scenarios/make_colin27.py            writes colin27/head.ply
    python assets/scenarios/make_colin27.py --check    only compares with the committed file

The same volume gives the same bytes with the library versions of requirements.lock.
"""

from __future__ import annotations

import argparse
import hashlib
import sys
import tempfile
from pathlib import Path

from rastrainer.errors import RASTrainerError
from rastrainer.head_mesh import write_head_mesh
from rastrainer.slicer.head.extraction import extract_head
from rastrainer.slicer.head.volume import read_volume

VOLUME = Path("/usr/share/mricron/templates/ch2.nii.gz")
VOLUME_SHA256 = "a009051127f64dc3dd554d5f5b589870ea72106d9642c21b4e7093e478cfc309"
HEAD = Path(__file__).parent / "colin27" / "head.ply"


def main() -> int:
    """Write the head, or compare it with the committed one."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("volume", nargs="?", type=Path, default=VOLUME, help="ch2.nii.gz")
    parser.add_argument("--check", action="store_true", help="compare, write nothing")
    arguments = parser.parse_args()
    try:
        return make(arguments.volume, arguments.check)
    except RASTrainerError as error:
        print(error, file=sys.stderr)
        return 2


def make(volume: Path, check: bool) -> int:
    """Return the exit status: 1 where the check found another head."""
    if not volume.is_file():
        print(f"{volume} is missing; install it: apt-get install mricron-data", file=sys.stderr)
        return 2
    if hashlib.sha256(volume.read_bytes()).hexdigest() != VOLUME_SHA256:
        print(f"{volume} is not the volume that the committed head was made of.", file=sys.stderr)
    mesh = extract_head(
        read_volume(volume), progress=lambda step, share: print(f"{share:4.0%}  {step}")
    )
    if not check:
        write_head_mesh(HEAD, mesh)
        return 0
    with tempfile.TemporaryDirectory() as folder:
        again = Path(folder) / HEAD.name
        write_head_mesh(again, mesh)
        same = again.read_bytes() == HEAD.read_bytes()
    print("The committed head is the same." if same else "The committed head differs.")
    return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main())
