"""The session of Slicer's module without Slicer, on stand-ins for its scene and connector."""

from __future__ import annotations

import sys
from pathlib import Path

from rastrainer.sections.module_session import ModulePaths, ModuleSession
from rastrainer.slicer.program.child_process import runHere
from rastrainer.slicer.program.simulator_package import SimulatorPackage
from rastrainer.study.database.database import PostgresAddress
from rastrainer.study.database.study import STUDY_FILE
from rastrainer_headless.connector import headlessKit
from rastrainer_headless.scene import HeadlessScene


def openSession(
    scene: HeadlessScene,
    folder: Path,
    assets: Path,
    studyAddress: PostgresAddress | None = None,
) -> ModuleSession:
    places = ModulePaths(
        assets=assets,
        python=Path(sys.executable),
        simulator=folder / "simulator",
        study=folder / STUDY_FILE,
        records=folder / "records",
        library=folder / "scenarios",
        package=SimulatorPackage(folder),
        studyAddress=studyAddress,
    )
    return ModuleSession(scene.scene, places, headlessKit, run=runHere)


def process(session: ModuleSession) -> None:
    """Do what Slicer's timers do; to be called every few milliseconds."""
    if session.link.connector is not None:
        session.link.connector.PeriodicProcess()
    session.process()
