"""From a volume to the draft of a head: checks, extraction, images and the skull, in one call."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from rastrainer.head.mesh import HeadMesh
from rastrainer.progress import Progress
from rastrainer.scenario.draft import HeadDraft
from rastrainer.slicer.head.extraction import find_head, skin_of
from rastrainer.slicer.head.head_body import HeadBody, HeadSettings
from rastrainer.slicer.head.images_and_skull import SCALP_MM, image_of, skull_of
from rastrainer.slicer.head.level_set import is_hounsfield
from rastrainer.slicer.head.segment import SegmentImage, for_segment, volume_of_segment
from rastrainer.slicer.head.volume import Volume, as_float, read_volume
from rastrainer.slicer.head.volume_checks import check_head, check_volume


def read_any_volume(path: Path) -> Volume:
    """Read an NRRD or NIfTI file, or a folder with a DICOM series.

    Raises:
        InputError: it cannot be read.
    """
    from rastrainer.slicer.head.dicom_series import read_dicom_folder

    return read_dicom_folder(path) if Path(path).is_dir() else read_volume(path)


def make_draft(
    volume: Volume,
    settings: HeadSettings | None = None,
    has_skull: bool = True,
    progress: Progress = lambda _step, _share: None,
    segment: SegmentImage | None = None,
    head_made: Callable[[HeadDraft, list[str]], None] = lambda _draft, _warnings: None,
    has_volume: bool = True,
) -> tuple[HeadDraft, list[str]]:
    """Return a head and warnings, one sentence each.

    Args:
        volume: T1-weighted MRI or CT of a head.
        settings: what to choose otherwise than usual.
        has_skull: whether the skull is wanted too.
        progress: told each step's name and the share of the work done; may raise to cancel.
        segment: the head; None finds it in the volume.
        head_made: given the draft without its skull and the warnings, before the skull is made.
        has_volume: whether the images are to be part of the draft.

    Raises:
        InputError: the volume cannot be used, or there is no head in it or no bone in a CT.
    """
    volume = as_float(volume)
    found, mesh, warnings = find_skin(
        volume, settings, lambda step, share: progress(step, 0.8 * share), segment
    )
    draft = HeadDraft(mesh, _head_method(found, segment is not None))
    if has_volume:
        progress("Preparing the images", 0.8)
        images, told = image_of(volume, found)
        draft = replace(draft, method=f"{draft.method} {told}", volume=images)
    head_made(draft, warnings)
    if has_skull:
        progress("Making the skull", 0.85)
        method = f"{draft.method} {_skull_method(found)}"
        skull = skull_of(volume, found)
        draft = replace(draft, method=method, skull=skull, is_skull_approximate=not found.is_ct)
    progress("Done", 1.0)
    return draft, warnings


def find_skin(
    volume: Volume,
    settings: HeadSettings | None = None,
    progress: Progress = lambda _step, _share: None,
    segment: SegmentImage | None = None,
) -> tuple[HeadBody, HeadMesh, list[str]]:
    """Return a head as voxels and as a surface, and warnings; otherwise as `make_draft`."""
    settings = settings or HeadSettings()
    volume = as_float(volume)
    warnings = check_volume(volume)
    if segment is not None:
        settings = for_segment(settings)
    searched = volume if segment is None else volume_of_segment(segment)
    found = find_head(searched, settings, progress)
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
