"""Slicer's application: where it keeps what the module needs, its views, dialogs and downloads."""

from __future__ import annotations

import contextlib
import urllib.error
import urllib.request
from collections.abc import Callable
from pathlib import Path
from typing import Any

import qt
import slicer

from rastrainer.errors import InputError
from rastrainer.home_folder import home_folder
from rastrainer.scenario.library import user_library
from rastrainer.sections.module_session import ModulePaths
from rastrainer.sections.sample_data import assetsFolder
from rastrainer.sections.views import WITH_PLOT, WITH_TABLE, BorrowedLayout
from rastrainer.slicer.background_work import CallLater, inBackground
from rastrainer.slicer.program.simulator_package import SimulatorPackage, pythonSlicer
from rastrainer.slicer.settings import STUDY, STUDY_ADDRESS, Settings
from rastrainer.slicer.translation import _
from rastrainer.study.database.database import study_place
from rastrainer.widgets.plain_text import toolTip
from rastrainer.work_progress import Progress


def findPlaces(moduleFile: Path, settings: Settings) -> ModulePaths:
    """Return the places for a module whose Python file this is."""
    paths = qt.QStandardPaths
    documents = Path(paths.writableLocation(paths.DocumentsLocation))
    data = Path(paths.writableLocation(paths.GenericDataLocation))
    study, address = settings.get(STUDY), None
    # An address that cannot be used is none.
    with contextlib.suppress(InputError):
        place = study_place(settings.get(STUDY_ADDRESS))
        address = None if isinstance(place, Path) else place
    return ModulePaths(
        assets=assetsFolder(moduleFile),
        python=pythonSlicer(Path(slicer.app.slicerHome)),
        simulator=data / "RASTrainer" / "simulator",
        study=Path(study) if study else documents / "RASTrainer" / "study.db",
        records=home_folder() / "RASTrainer" / "trials",
        library=user_library(),
        package=SimulatorPackage.of(moduleFile.parent),
        studyAddress=address,
    )


def callSoon(work: Callable[[], None]) -> None:
    qt.QTimer.singleShot(0, work)


def isAnythingVisible(isEntered: bool, inSlices: bool = False) -> bool:
    """Return whether the module is entered or a view shown, in a window that is not minimized.

    The parts of a minimized window still call themselves visible. By `inSlices` slice views count
    as well as 3D views.
    """
    window = slicer.util.mainWindow()
    if window is not None and window.minimized:
        return False
    layoutManager = slicer.app.layoutManager()
    if isEntered or layoutManager is None:
        return isEntered
    views = [layoutManager.threeDWidget(index) for index in range(layoutManager.threeDViewCount)]
    if inSlices:
        views += [layoutManager.sliceWidget(name) for name in layoutManager.sliceViewNames()]
    return any(view.visible for view in views)


def fitThreeDViews() -> None:
    """Move the cameras of the 3D views so that everything visible is in view."""
    if slicer.app.layoutManager() is not None:
        slicer.util.resetThreeDViews()


def fitSliceViews(later: CallLater) -> None:
    """Let the slice views show their volumes as a whole, one view after the other by `later`.

    That moves their slices, too.
    """
    layoutManager = slicer.app.layoutManager()
    for name in () if layoutManager is None else layoutManager.sliceViewNames():
        later(layoutManager.sliceWidget(name).sliceLogic().FitSliceToAll)


CURVE, CALIBRATION, TABLES = "learning curve", "calibration", "tables"


def showChart(layout: BorrowedLayout, chart: Any, purpose: str = CURVE) -> None:
    layout.show(purpose, WITH_PLOT)
    logic = slicer.app.applicationLogic()
    logic.GetSelectionNode().SetActivePlotChartID(chart.GetID())
    logic.PropagatePlotChartSelection()


def showTable(layout: BorrowedLayout, table: Any) -> None:
    """Show a `vtkMRMLTableNode` in a layout that has a table view, where others can be chosen."""
    layout.show(TABLES, WITH_TABLE)
    logic = slicer.app.applicationLogic()
    logic.GetSelectionNode().SetActiveTableID(table.GetID())
    logic.PropagateTableSelection()


def askWhereToSave(caption: str, proposed: str, kind: str) -> Path | None:
    """Return the path of a file to be written, with the proposed suffix; None if canceled.

    `kind` is a filter such as `CSV (*.csv)`.
    """
    chosen = qt.QFileDialog.getSaveFileName(slicer.util.mainWindow(), caption, proposed, kind)
    if not chosen:
        return None
    suffix = Path(proposed).suffix
    if chosen.lower().endswith(suffix):
        return Path(chosen)
    path = Path(chosen + suffix)
    # The dialog has checked only the name without the suffix.
    question = _("{path} already exists. Replace it?").format(path=path)
    if path.exists() and not slicer.util.confirmYesNoDisplay(toolTip(question), caption):
        return None
    return path


ANSWER_S = 10.0
"""Sample Data itself would wait for a silent network as long as the system does."""


def downloadSample(scene: Any, logic: Any, name: str, progress: Progress) -> Any:
    """Return the volume of a sample, downloaded unless Slicer has kept it from before.

    `logic` belongs to the module Sample Data.
    """
    source = logic.sourceForSampleName(name)
    if source is None:
        raise InputError(_("This Slicer's Sample Data has no {name}.").format(name=name))
    problem = _(
        "{name} could not be downloaded. Connect this computer to the Internet and try "
        "again, or open an MRI of your own: menu File, Add Data."
    ).format(name=name)

    def checkReachable(_report: Progress) -> None:
        request = urllib.request.Request(source.uris[0], method="HEAD")
        try:
            with urllib.request.urlopen(request, timeout=ANSWER_S):
                pass
        except urllib.error.HTTPError:
            return  # It answers; Sample Data will find out whether it has the file.
        except (OSError, ValueError):
            raise InputError(problem) from None

    kept = Path(scene.GetCacheManager().GetRemoteCacheDirectory(), source.fileNames[0])
    if not kept.is_file():
        inBackground(checkReachable, progress)
    volumes = [node for node in logic.downloadSamples(name) if node is not None]
    if not volumes:
        raise InputError(problem)
    return volumes[0]
