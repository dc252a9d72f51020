"""Where the module finds and writes its files."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from rastrainer.slicer.program.simulator_package import SimulatorPackage
from rastrainer.study.database.database import PostgresAddress


@dataclass(frozen=True)
class ModulePaths:
    """Where the session reads and writes files.

    Attributes:
        python: that sets the simulator up, runs it, and does long work in separate processes.
        study: file of the study, until another is chosen.
        records: folder of the journals of the simulator that is started from here.
        library: folder of the user's own scenarios, which the simulator knows too.
        studyAddress: of the study in PostgreSQL; None for that of the file.
    """

    assets: Path
    python: Path
    simulator: Path
    study: Path
    records: Path
    library: Path
    package: SimulatorPackage
    studyAddress: PostgresAddress | None = None
