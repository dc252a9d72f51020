"""Where Slicer keeps what the module needs: assets, the user's folders, its own Python."""

from __future__ import annotations

from pathlib import Path

import qt
import slicer

from rastrainer.scenario_library import user_library
from rastrainer.slicer.session import Places
from rastrainer.slicer.settings import STUDY, Settings
from rastrainer.slicer.simulator_package import SimulatorPackage
from rastrainer.slicer.simulator_place import pythonSlicer


def findPlaces(moduleFile: Path, settings: Settings) -> Places:
    """Return the places for a module whose Python file this is."""
    paths = qt.QStandardPaths
    documents = Path(paths.writableLocation(paths.DocumentsLocation))
    data = Path(paths.writableLocation(paths.GenericDataLocation))
    study = settings.get(STUDY)
    return Places(
        assets=assetsFolder(moduleFile),
        python=pythonSlicer(Path(slicer.app.slicerHome)),
        simulator=data / "RASTrainer" / "simulator",
        study=Path(study) if study else documents / "RASTrainer" / "study.db",
        records=Path.home() / "RASTrainer" / "trials",
        library=user_library(),
        package=SimulatorPackage.of(moduleFile.parent),
    )


def assetsFolder(moduleFile: Path) -> Path:
    """Return where scenarios and the robot are: installed with the module, or in a checkout."""
    installed = moduleFile.parent / "Resources" / "RASTrainer"
    return installed if installed.is_dir() else moduleFile.parents[1] / "assets"
