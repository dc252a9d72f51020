# ruff: noqa: ARG002, I001, PT009, UP007, UP045 (the order of imports, observers and assertions is Slicer's)
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, Optional, Union

import qt

import slicer
from slicer import vtkMRMLMarkupsFiducialNode, vtkMRMLMarkupsLineNode
from slicer.i18n import tr as _
from slicer.i18n import translate
from slicer.ScriptedLoadableModule import *
from slicer.util import VTKObservationMixin
from slicer.parameterNodeWrapper import parameterNodeWrapper

if TYPE_CHECKING:
    from rastrainer.sections.panel_stack import PanelStack
    from rastrainer.slicer.turns import Turns

#
# RASTrainer
#


class RASTrainer(ScriptedLoadableModule):
    """The module as Slicer lists it.

    It does not depend on the module OpenIGTLinkIF: without it, connecting says what to install, and
    everything else works.
    """

    def __init__(self, parent):
        ScriptedLoadableModule.__init__(self, parent)
        parent.title = _("Robot-Assisted Surgery Trainer")
        parent.categories = [translate("qSlicerAbstractCoreModule", "Training")]
        parent.dependencies = []
        parent.contributors = [
            "RASTrainer organization (https://github.com/RASTrainer/RASTrainer/issues)"
        ]
        parent.helpText = _(
            "A trainee drives a simulated robot to fifteen numbered points on a head and touches "
            "them. The touched points arrive here over OpenIGTLink, are registered to the same "
            "points in the patient's MRI, and the trial is scored and kept. Patients' images in "
            "DICOM are loaded with Slicer's module DICOM; nothing is sent anywhere. Not for "
            "clinical use. See more information in "
            '<a href="https://github.com/RASTrainer/RASTrainer">the documentation</a>.'
        )
        parent.acknowledgementText = _(
            "Method, tasks and the score CTPS follow the paper <i>Virtual reality-based training "
            "simulator for robot-assisted surgery using Unity and 3D slicer</i> (its video: "
            '<a href="https://www.youtube.com/watch?v=73omjcOy2lU">73omjcOy2lU</a>). The head is '
            "made of the MRI Colin27: C. J. Holmes, R. Hoge, L. Collins, R. Woods, A. W. Toga, "
            "A. C. Evans, <i>Enhancement of MR images using registration for signal averaging</i>, "
            "Journal of Computer Assisted Tomography 22(2), 1998, "
            '<a href="https://doi.org/10.1097/00004728-199803000-00032">'
            "doi:10.1097/00004728-199803000-00032</a>. Please cite both."
        )
        logicFolder = str(Path(__file__).parent / "Logic")
        if logicFolder not in sys.path:
            sys.path.insert(0, logicFolder)
        # Sample Data may be loaded later than this module.
        slicer.app.connect("startupCompleted()", registerSampleData)


#
# Register sample data sets in Sample Data module
#


def registerSampleData():
    """Add the MRI that comes with this module to the module Sample Data."""
    from rastrainer.sections.sample_data import assetsFolder
    from rastrainer.sections.sample_data import registerSampleData as register

    register(assetsFolder(Path(__file__)))


#
# RASTrainerParameterNode
#


@parameterNodeWrapper
class RASTrainerParameterNode:
    """Nodes that the user has chosen, saved with the scene.

    What else is chosen stays with the user: see `rastrainer.slicer.settings`.

    movingPoints - points in the robot's World that are registered; the touches where none
    fixedPoints - the same points on the MRI; the task's fiducials where none
    target - its first point is where the target error is reported; the scenario's where none
    plan - a planned target or trajectory
    """

    movingPoints: vtkMRMLMarkupsFiducialNode
    fixedPoints: vtkMRMLMarkupsFiducialNode
    target: vtkMRMLMarkupsFiducialNode
    plan: Optional[Union[vtkMRMLMarkupsFiducialNode, vtkMRMLMarkupsLineNode]]


#
# RASTrainerWidget
#


class RASTrainerWidget(ScriptedLoadableModuleWidget, VTKObservationMixin):
    """Wires the panels to the logic; they are in `rastrainer.sections`."""

    SOON_MS = 100

    def __init__(self, parent=None) -> None:
        ScriptedLoadableModuleWidget.__init__(self, parent)
        VTKObservationMixin.__init__(self)
        self._logic: Optional[RASTrainerLogic] = None
        self._building: Optional[Turns] = None
        self._panels: Optional[PanelStack] = None
        self.ui: Any = None
        self._parameterNode: Any = None
        self._parameterNodeGuiTag: Any = None
        self._uiWidget: Any = None
        self._timer: Any = None
        self._workTimer: Any = None
        self._isWoken = False

    @property
    def logic(self) -> Optional["RASTrainerLogic"]:
        """The logic; asking for it has the panel built at once, if it is not yet."""
        if self._building is not None:
            self._building.finish()
        return self._logic

    def setup(self) -> None:
        from rastrainer.slicer.turns import Turns

        ScriptedLoadableModuleWidget.setup(self)
        self._uiWidget = slicer.util.loadUI(self.resourcePath("UI/RASTrainer.ui"))
        self._uiWidget.setMRMLScene(slicer.mrmlScene)
        # Slicer's window answers between imports and sections.
        self._building = Turns(self._build(), lambda step: qt.QTimer.singleShot(0, step))

    def _build(self):
        from rastrainer.slicer.turns import importInTurns

        yield from importInTurns("rastrainer.sections.panel_stack")
        from rastrainer.sections.application import isAnythingVisible
        from rastrainer.sections.panel_stack import PanelStack
        from rastrainer.slicer.background_work import PERIOD_MS

        scene = slicer.mrmlScene
        self._logic = RASTrainerLogic()
        session = self._logic.session
        session.isSeen = lambda inSlices: isAnythingVisible(self.parent.isEntered, inSlices)
        self.addObserver(scene, scene.StartCloseEvent, self.onSceneStartClose)
        self.addObserver(scene, scene.EndCloseEvent, self.onSceneEndClose)
        self._panels = PanelStack()
        yield from self._panels.build(self._uiWidget, self.resourcePath, session)
        self.ui = self._panels.ui
        self.layout.addWidget(self._uiWidget)
        self.initializeParameterNode()
        # Trials arrive whether or not this module is shown.
        self._timer = qt.QTimer()
        self._timer.setSingleShot(True)
        self._timer.connect("timeout()", self.onTimeout)
        session.woken.connect(self.wake)
        self.wake()
        self._workTimer = qt.QTimer()
        self._workTimer.setInterval(PERIOD_MS)
        self._workTimer.connect("timeout()", self.onWorkTimeout)
        session.work.began.connect(self._workTimer.start)

    def cleanup(self) -> None:
        if self._building is not None:
            self._building.isOver = True
        for timer, slot in ((self._timer, self.onTimeout), (self._workTimer, self.onWorkTimeout)):
            if timer is not None:
                timer.stop()
                timer.disconnect("timeout()", slot)
        if self._panels is not None:
            self._panels.close()
        if self._logic is not None:
            self._logic.session.woken.disconnect(self.wake)
            self._logic.session.close()
        self.setParameterNode(None)
        self.removeObservers()
        if self._uiWidget is not None:
            # Reload would only hide it, and its connections would keep all of this alive.
            self._uiWidget.setParent(None)
            self._uiWidget.deleteLater()
            self._uiWidget = None

    def enter(self) -> None:
        self.initializeParameterNode()
        self.wake()

    def exit(self) -> None:
        if self._logic is not None:
            self._logic.session.layout.giveBack()
        self.setParameterNode(None)
        self.wake()

    def wake(self) -> None:
        """Have `onTimeout` called soon; this may be inside VTK."""
        if self._timer is not None and not self._isWoken:
            self._isWoken = True
            self._timer.start(self.SOON_MS)

    def onTimeout(self) -> None:
        if self._logic is None:
            return
        self._isWoken = False
        try:
            self._logic.session.process()
        finally:
            restS = self._logic.session.restS(self.parent.isEntered)
            if restS is not None and not self._isWoken:
                self._timer.start(round(1000 * restS))

    def onWorkTimeout(self) -> None:
        if self._logic is None or not self._logic.session.yieldTimeToWork():
            self._workTimer.stop()

    def onSceneStartClose(self, caller=None, event=None) -> None:
        self.setParameterNode(None)
        if self._logic is not None:
            # The scene would take too long to delete the states of a replay at once.
            self._logic.session.replay.keepStates()

    def onSceneEndClose(self, caller=None, event=None) -> None:
        if self._logic is not None:
            self._logic.session.sceneWasCleared()
        if self.parent.isEntered:
            self.initializeParameterNode()

    def initializeParameterNode(self) -> None:
        if self._logic is not None and self.ui is not None:
            self.setParameterNode(self._logic.getParameterNode())

    def setParameterNode(self, parameterNode) -> None:
        if self._parameterNode is not None:
            self._parameterNode.disconnectGui(self._parameterNodeGuiTag)
        self._parameterNode = parameterNode
        if parameterNode is not None:
            self._parameterNodeGuiTag = parameterNode.connectGui(self.ui)


#
# RASTrainerLogic
#


class RASTrainerLogic(ScriptedLoadableModuleLogic):
    """All work of the module without its widgets; the parts are in `rastrainer.sections`."""

    def __init__(self) -> None:
        from rastrainer.sections.application import callSoon, findPlaces
        from rastrainer.slicer.link.link import desktopKit
        from rastrainer.sections.module_session import ModuleSession
        from rastrainer.slicer.settings import Settings

        ScriptedLoadableModuleLogic.__init__(self)
        settings = Settings(slicer.app.settings())
        places = findPlaces(Path(__file__), settings)
        self.session = ModuleSession(slicer.mrmlScene, places, desktopKit, settings, callSoon)

    def getParameterNode(self):
        # Its decorator gives the class this constructor, which types cannot express.
        wrapped: Any = RASTrainerParameterNode
        return wrapped(super().getParameterNode())


#
# RASTrainerTest
#


class RASTrainerTest(ScriptedLoadableModuleTest):
    """Runs in Slicer, by the Reload and Test button and by CTest; needs no simulator."""

    def setUp(self):
        slicer.mrmlScene.Clear()

    def test_theModuleStartsAndItsWidgetIsWired(self):
        widget = slicer.util.getModuleWidget("RASTrainer")
        if slicer.util.mainWindow() is None:
            widget.enter()
        else:
            slicer.util.selectModule("RASTrainer")
        self.assertIsNotNone(widget.logic)
        self.assertTrue(widget._timer.isActive())
        self.assertIsNotNone(widget._parameterNodeGuiTag)
        target = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLMarkupsFiducialNode", "Target")
        widget._parameterNode.target = target
        self.assertEqual(widget.ui.targetComboBox.currentNodeID, target.GetID())

    def test_touchesAreRegisteredAndABadOneIsLeftOutByOneClick(self):
        fixture = self.fixture()
        ui = fixture.ui
        fixture.showScenario()
        touches = fixture.touches()
        touches[6] += 9.0
        fixture.touch(touches)
        self.assertEqual(ui.residualsTable.rowCount, 15)
        self.assertIn("7", fixture.child("warning0Text").text)
        fixture.child("remedy0Button").click()
        fixture.process()
        self.assertEqual(ui.residualsTable.rowCount, 14)
        ui.undoButton.click()
        fixture.process()
        self.assertEqual(ui.residualsTable.rowCount, 15)

    def test_theSceneMayBeClearedAndEveryNodeDeleted(self):
        fixture = self.fixture()
        fixture.showScenario()
        fixture.ui.robotCheckBox.checked = True
        fixture.touch(fixture.touches())
        slicer.mrmlScene.Clear()
        fixture.process()
        self.assertEqual(fixture.ui.residualsTable.rowCount, 0)
        fixture.showScenario()
        fixture.touch(fixture.touches())
        for node in list(slicer.util.getNodesByClass("vtkMRMLDisplayableNode")):
            if node.GetScene() is not None and not node.GetSingletonTag():
                slicer.mrmlScene.RemoveNode(node)
                fixture.process()
        self.assertGreater(len(fixture.ui.registrationText.text), 20)

    def fixture(self):
        from rastrainer.sections.self_test_fixture import SelfTestFixture

        return SelfTestFixture(slicer.util.getModuleWidget("RASTrainer"))
