"""Make the default scenario's head, skull and volume of the MRI Colin27 in Debian's mricron-data.

    python assets/scenarios/make_colin27.py            writes head, skull and volume of colin27
    python assets/scenarios/make_colin27.py --check    only compares with the committed files

The same MRI gives the same bytes with the library versions of requirements/base.lock. The volumes'
voxels are compared, since other versions of zlib pack the same voxels otherwise.
"""

import argparse
import filecmp
import hashlib
import sys
import tempfile
from pathlib import Path

import numpy as np

from rastrainer.errors import RASTrainerError
from rastrainer.head.mesh import write_head_mesh
from rastrainer.head.volume import read_nrrd, write_nrrd
from rastrainer.slicer.head.head_draft import makeDraft
from rastrainer_headless.volume_files import readVolume

MRI = Path("/usr/share/mricron/templates/ch2.nii.gz")
MRI_SHA256 = "a009051127f64dc3dd554d5f5b589870ea72106d9642c21b4e7093e478cfc309"
FOLDER = Path(__file__).parent / "colin27"
HEAD, SKULL, VOLUME = "head.ply", "skull.ply", "volume.nrrd"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("mri", nargs="?", type=Path, default=MRI, help="ch2.nii.gz")
    parser.add_argument("--check", action="store_true", help="compare, write nothing")
    arguments = parser.parse_args()
    try:
        return make(arguments.mri, arguments.check)
    except RASTrainerError as error:
        print(error, file=sys.stderr)
        return 2


def make(mri: Path, check: bool) -> int:
    """Return the exit status: 1 where the check found another head, skull or volume."""
    if not mri.is_file():
        print(f"{mri} is missing; install it: apt-get install mricron-data", file=sys.stderr)
        return 2
    if hashlib.sha256(mri.read_bytes()).hexdigest() != MRI_SHA256:
        print(f"{mri} is not the MRI that the committed files were made of.", file=sys.stderr)
    draft, _ = makeDraft(
        readVolume(mri), progress=lambda step, share: print(f"{share:4.0%}  {step}")
    )
    volume = draft.volume
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary) if check else FOLDER
        write_head_mesh(folder / HEAD, draft.head)
        write_head_mesh(folder / SKULL, draft.skull)
        write_nrrd(folder / VOLUME, volume.values, volume.ijk_to_ras)
        if not check:
            size = (FOLDER / VOLUME).stat().st_size
            print(f"{draft.method}\nwindow {volume.window:g}, level {volume.level:g}, {size} bytes")
            return 0
        same = {
            **{name: filecmp.cmp(folder / name, FOLDER / name, False) for name in (HEAD, SKULL)},
            VOLUME: all(
                map(np.array_equal, read_nrrd(folder / VOLUME), read_nrrd(FOLDER / VOLUME))
            ),
        }
    for name, is_same in same.items():
        print(f"The committed {Path(name).stem} {'is the same' if is_same else 'differs'}.")
    return 0 if all(same.values()) else 1


if __name__ == "__main__":
    sys.exit(main())
