"""Slicer's module Sample Data: registered samples, and their way into the scene."""

from __future__ import annotations

import logging
import urllib.request
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import slicer

OWN_SAMPLE = "MRBrainTumor1"
"""One of those that come with Slicer."""


@dataclass(frozen=True)
class SampleDataSource:
    """A sample of one file, whose address, name and checksum Slicer keeps in lists."""

    sampleName: str
    uris: list[str]
    fileNames: list[str]
    nodeNames: list[str]
    thumbnailFileName: str | None = None
    checksums: list[str | None] = field(default_factory=lambda: [None])


class SampleDataLogic:
    """Stands in for the logic of Sample Data. What Slicer would download is made here instead."""

    def __init__(self) -> None:
        self.uri = Path(__file__).as_uri()
        self.attempts = 0

    @staticmethod
    def registerCustomSampleDataSource(
        category: str = "Custom",
        sampleName: str | None = None,
        uris: str | None = None,
        fileNames: str | None = None,
        nodeNames: str | None = None,
        customDownloader: Any = None,
        thumbnailFileName: str | None = None,
        loadFileType: str = "VolumeFile",
        loadFiles: bool | None = None,
        loadFileProperties: Mapping[str, Any] | None = None,
        checksums: str | None = None,
    ) -> None:
        if customDownloader or loadFiles or loadFileProperties or loadFileType != "VolumeFile":
            raise NotImplementedError("The host does not offer this way to load a sample yet.")
        slicer.util.extractAlgoAndDigest(checksums)
        source = SampleDataSource(
            sampleName, [uris], [fileNames], [nodeNames], thumbnailFileName, [checksums]
        )
        known = SampleDataLogic.sampleDataSourcesByCategory(category)
        if source not in known:
            SampleDataLogic.sampleDataSourcesByCategory()[category] = [*known, source]

    @staticmethod
    def sampleDataSourcesByCategory(category: str | None = None) -> Any:
        if not hasattr(slicer.modules, "sampleDataSources"):
            slicer.modules.sampleDataSources = {}
        sources = slicer.modules.sampleDataSources
        return sources if category is None else sources.get(category, [])

    def sourceForSampleName(self, name: str) -> SampleDataSource | None:
        for sources in SampleDataLogic.sampleDataSourcesByCategory().values():
            for source in sources:
                if source.sampleName == name:
                    return source
        if name != OWN_SAMPLE:
            return None
        return SampleDataSource(name, [self.uri], [f"{name}.nrrd"], [name])

    def downloadSamples(self, name: str) -> list[Any]:
        """Return the loaded nodes; none if nothing came: only the log says so."""
        self.attempts += 1
        source = self.sourceForSampleName(name)
        if source is None:
            return []
        if name != OWN_SAMPLE:
            return [_load(source)]
        if not self.uri.startswith("file:"):
            logging.error("Download failed (attempt 3 of 3)...")
            return []
        values = np.full((8, 8, 8), 100, dtype=np.int16)
        return [slicer.util.addVolumeFromArray(values, name=name)]

    def downloadSample(self, name: str) -> Any:
        return self.downloadSamples(name)[0]


def _load(source: SampleDataSource) -> Any:
    """Fetch the file into the cache, compare its checksum, and load it without storage."""
    path = Path(slicer.app.temporaryPath, source.fileNames[0])
    urllib.request.urlretrieve(source.uris[0], path)
    algorithm, digest = slicer.util.extractAlgoAndDigest(source.checksums[0])
    assert slicer.util.computeChecksum(algorithm, str(path)) == digest
    storage = slicer.vtkMRMLVolumeArchetypeStorageNode()
    storage.SetFileName(str(path))
    node = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLScalarVolumeNode", source.nodeNames[0])
    assert storage.ReadData(node) == 1
    return node


def make_module() -> ModuleType:
    module = ModuleType("SampleData")
    module.SampleDataLogic = SampleDataLogic
    return module
