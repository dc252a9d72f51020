"""From a volume to the draft of a head: checks, extraction and the skull, in one call."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from rastrainer.head_mesh import HeadMesh
from rastrainer.progress import Progress
from rastrainer.scenario_draft import HeadDraft
from rastrainer.slicer.head.dicom_series import read_dicom_folder
from rastrainer.slicer.head.extraction import HeadBody, HeadSettings, find_head, skin_of
from rastrainer.slicer.head.segment import for_segment
from rastrainer.slicer.head.skull import SCALP_MM, skull_of
from rastrainer.slicer.head.tissue import is_hounsfield
from rastrainer.slicer.head.volume import Volume, read_volume
from rastrainer.slicer.head.volume_checks import check_head, check_volume


def read_any_volume(path: Path) -> Volume:
    """Read an NRRD or NIfTI file, or a folder with a DICOM series.

    Raises:
        InputError: it cannot be read.
    """
    return read_dicom_folder(path) if Path(path).is_dir() else read_volume(path)


def make_draft(
    volume: Volume,
    settings: HeadSettings | None = None,
    has_skull: bool = True,
    progress: Progress = lambda _step, _share: None,
    segment: Volume | None = None,
    head_made: Callable[[HeadDraft, list[str]], None] = lambda _draft, _warnings: None,
) -> tuple[HeadDraft, list[str]]:
    """Return a head and warnings, one sentence each.

    Args:
        volume: T1-weighted MRI or CT of a head.
        settings: what to choose otherwise than usual.
        has_skull: whether the skull is wanted too.
        progress: told each step's name and the share of the work done; may raise to cancel.
        segment: the head as `volume_of_segment` returns it; None finds it in the volume.
        head_made: given the draft without its skull and the warnings, before the skull is made.

    Raises:
        InputError: the volume cannot be used, or there is no head in it or no bone in a CT.
    """
    found, mesh, warnings = find_skin(
        volume, settings, lambda step, share: progress(step, 0.8 * share), segment
    )
    draft = HeadDraft(mesh, _head_method(found, segment is not None))
    head_made(draft, warnings)
    if has_skull:
        progress("Making the skull", 0.85)
        method = f"{draft.method} {_skull_method(found)}"
        draft = HeadDraft(mesh, method, skull_of(volume, found), not found.is_ct)
    progress("Done", 1.0)
    return draft, warnings


def find_skin(
    volume: Volume,
    settings: HeadSettings | None = None,
    progress: Progress = lambda _step, _share: None,
    segment: Volume | None = None,
) -> tuple[HeadBody, HeadMesh, list[str]]:
    """Return a head as voxels and as a surface, and warnings; otherwise as `make_draft`."""
    settings = settings or HeadSettings()
    warnings = check_volume(volume)
    if segment is not None:
        settings = for_segment(settings)
    found = find_head(volume if segment is None else segment, settings, progress)
    if segment is not None:
        found = replace(found, is_ct=is_hounsfield(volume.values))
    mesh = skin_of(found, settings, progress)
    check_head(mesh)
    return found, mesh, warnings


def _head_method(found: HeadBody, is_segment: bool) -> str:
    kind = "CT" if found.is_ct else "MRI"
    how = "segment edited by hand" if is_segment else f"threshold {found.threshold:.5g}"
    return (
        f"Surface of the skin from {kind} by rastrainer, {how}, cavities filled, cut flat at "
        f"{found.base_mm:.1f} mm (S)."
    )


def _skull_method(found: HeadBody) -> str:
    if found.is_ct:
        return "Skull: bone of the CT."
    return f"Skull: an approximation, the skin moved inward by {SCALP_MM:g} mm; MRI shows no bone."
