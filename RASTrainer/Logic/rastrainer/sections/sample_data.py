"""The MRI that comes with the module, in Slicer's module Sample Data.

Slicer registers it whenever it starts, so nothing else of ours is imported here.
"""

from __future__ import annotations

from pathlib import Path

import slicer

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


def assetsFolder(moduleFile: Path) -> Path:
    """Return where scenarios and the robot are: installed with the module, or in a checkout."""
    installed = moduleFile.parent / "Resources" / "RASTrainer"
    return installed if installed.is_dir() else moduleFile.parents[1] / "assets"
