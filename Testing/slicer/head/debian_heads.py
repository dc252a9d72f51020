"""Heads of real people that Debian has: an MRI of mricron-data, a CT of invesalius-examples."""

from __future__ import annotations

import plistlib
import tarfile
from pathlib import Path

import numpy as np

from rastrainer.slicer.head.volume import Volume
from Testing.slicer.head.volume_file import write_volume

COLIN27 = Path("/usr/share/mricron/templates/ch2.nii.gz")
CT_PROJECT = Path("/usr/share/doc/invesalius-examples/examples/Cranium.inv3")


def write_ct(path: Path) -> Path:
    """Write the CT of an InVesalius project as an NRRD file and return its path.

    The project is a tar file with the voxels, slice by slice from below, rows from the back of the
    head to its front and columns from its right to its left. Here rows begin at the front: Slicer's
    readers want right-handed axes.
    """
    with tarfile.open(CT_PROJECT) as project:
        members = {Path(member.name).name: member for member in project}
        matrix = plistlib.load(project.extractfile(members["main.plist"]))
        spacing, shape = matrix["spacing"], matrix["matrix"]["shape"]
        values = project.extractfile(members[matrix["matrix"]["filename"]]).read()
    values = np.frombuffer(values, np.int16).reshape(shape)[:, ::-1].transpose(2, 1, 0)
    across, along, up = spacing
    # From LPS to RAS.
    return write_volume(path, Volume(values, np.diag([-across, -along, up, 1.0])))
