"""Whether a volume's file states how the patient lies.

Readers give an orientation to every volume, also where its file states none.
"""

from __future__ import annotations

import gzip
import zlib
from pathlib import Path

import vtk

_READ_BYTES = 4096
_PICTURES = (b"\x89PNG", b"\xff\xd8\xff", b"BM", b"II*\0", b"MM\0*", b"# vtk")
"""How files begin that never state an orientation."""


def missingOrientation(path: Path) -> str:
    """Return why a file says nothing of where the patient's left and front are; empty if it does.

    A file that is not there any more is not doubted.
    """
    begin, nifti = beginOf(path), niftiHeader(path)
    if nifti is not None:
        if isAnalyze(nifti):
            return "Analyze files have none"
        isPlaced = nifti.GetQFormCode() or nifti.GetSFormCode()
        return "" if isPlaced else "its qform_code and sform_code are 0"
    if begin.startswith(b"NRRD") and not {"space", "space directions"} <= nrrdFields(begin).keys():
        return "it has no space directions"
    if b"ObjectType" in begin[:200] and not any(
        name in begin for name in (b"\nTransformMatrix =", b"\nOrientation =", b"\nRotation =")
    ):
        return "it has no TransformMatrix"
    return "it is a picture" if begin.startswith(_PICTURES) else ""


def beginOf(path: Path) -> bytes:
    """Return the first bytes of a file, unpacked."""
    try:
        with path.open("rb") as file:
            begin = file.read(_READ_BYTES)
            if begin.startswith(b"\x1f\x8b"):
                file.seek(0)
                with gzip.open(file) as unpacked:
                    begin = unpacked.read(_READ_BYTES)
    except (OSError, EOFError, zlib.error):
        return b""
    return begin


def niftiHeader(path: Path) -> vtk.vtkNIFTIImageHeader | None:
    """Return the header of a NIfTI or Analyze 7.5 file; None for other files."""
    reader = vtk.vtkNIFTIImageReader()
    if not reader.CanReadFile(str(path)):
        return None
    reader.SetFileName(str(path))
    isLoud = reader.GetGlobalWarningDisplay()
    reader.GlobalWarningDisplayOff()
    reader.UpdateInformation()
    reader.SetGlobalWarningDisplay(isLoud)
    return reader.GetNIFTIHeader()


def isAnalyze(header: vtk.vtkNIFTIImageHeader) -> bool:
    return header.GetMagic()[:3] not in ("n+1", "ni1", "n+2", "ni2")


def nrrdFields(begin: bytes) -> dict[str, str]:
    header, _, _ = begin.replace(b"\r\n", b"\n").partition(b"\n\n")
    lines = [line.partition(":") for line in header.decode("latin-1").split("\n")]
    return {
        name.strip().lower(): value.strip()
        for name, separator, value in lines
        if separator and not name.startswith("#") and not value.startswith("=")
    }
