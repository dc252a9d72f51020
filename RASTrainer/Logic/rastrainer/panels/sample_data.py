"""The built-in head's MRI among the samples of Slicer's module Sample Data; it comes with us."""

from __future__ import annotations

import urllib.error
import urllib.request
from pathlib import Path
from typing import Any

import slicer

from rastrainer.errors import InputError
from rastrainer.progress import Progress
from rastrainer.slicer.background_work import inBackground
from rastrainer.slicer.translation import _

CATEGORY, SAMPLE = "RASTrainer", "Colin27Head"
SCENARIO = Path("scenarios", "colin27")
VOLUME, THUMBNAIL = "volume.nrrd", "preview.png"


def registerSampleData(assets: Path) -> None:
    """Register the MRI below the folder of assets; nothing happens where either is not there.

    The file lies on this computer, so that the sample needs no network. Its checksum makes Sample
    Data fetch it again where its cache has one of an older version.
    """
    try:
        import SampleData
    except ImportError:
        return
    volume = assets / SCENARIO / VOLUME
    if not volume.is_file():
        return
    SampleData.SampleDataLogic.registerCustomSampleDataSource(
        category=CATEGORY,
        sampleName=SAMPLE,
        thumbnailFileName=str(assets / SCENARIO / THUMBNAIL),
        uris=volume.resolve().as_uri(),
        fileNames=f"{SAMPLE}.nrrd",
        nodeNames=SAMPLE,
        checksums=f"SHA256:{slicer.util.computeChecksum('SHA256', str(volume))}",
    )


ANSWER_S = 10.0
"""Sample Data itself would wait for a silent network as long as the system does."""


def downloadSample(scene: Any, logic: Any, name: str, progress: Progress) -> Any:
    """Return the volume of a sample, downloaded unless Slicer has kept it from before.

    Args:
        scene: the scene, into which Sample Data loads.
        logic: of the module Sample Data.
        name: of the sample.
        progress: called while the network is checked; may raise to cancel.

    Raises:
        InputError: the network does not answer, or the sample cannot be loaded.
    """
    source = logic.sourceForSampleName(name)
    if source is None:
        raise InputError(_("This Slicer's Sample Data has no {name}.").format(name=name))
    kept = Path(scene.GetCacheManager().GetRemoteCacheDirectory(), source.fileNames[0])
    if not kept.is_file():
        inBackground(lambda _report: _checkReachable(source.uris[0], name), progress)
    volumes = [node for node in logic.downloadSamples(name) if node is not None]
    if not volumes:
        raise InputError(_notBrought(name))
    return volumes[0]


def _checkReachable(uri: str, name: str) -> None:
    """Ask once, with a limit, whether there is a network at all."""
    try:
        with urllib.request.urlopen(urllib.request.Request(uri, method="HEAD"), timeout=ANSWER_S):
            pass
    except urllib.error.HTTPError:
        return  # It answers; whether it has the file is Sample Data's to find out.
    except (OSError, ValueError):
        raise InputError(_notBrought(name)) from None


def _notBrought(name: str) -> str:
    return _(
        "{name} could not be downloaded. Connect this computer to the Internet and try "
        "again, or open an MRI of your own: menu File, Add Data."
    ).format(name=name)
