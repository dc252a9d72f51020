"""A small Slicer for tests: it runs the unmodified module on PySide6 and slicer-core."""

from __future__ import annotations

import importlib.util
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import slicer
from PySide6 import QtCore, QtGui, QtTest, QtWidgets

from rastrainer.slicer.headless_command import HeadlessCommand
from rastrainer.slicer.headless_connector import HeadlessConnector
from Testing.slicer.host import appearance, pictures
from Testing.slicer.host.answers import ANSWERS, Message
from Testing.slicer.host.application import Application
from Testing.slicer.host.failures import FAILURES
from Testing.slicer.host.home import Home
from Testing.slicer.host.installation import Installation
from Testing.slicer.host.lasting_none import lend_references_to_none
from Testing.slicer.host.layout import LayoutManager
from Testing.slicer.host.proxy import wrap
from Testing.slicer.host.qt_module import class_named
from Testing.slicer.host.scene import ApplicationScene
from Testing.slicer.host.scripted_module import ModuleDescription

MODULE_FILE = Path(__file__).parents[3] / "RASTrainer" / "RASTrainer.py"
CONNECTOR_PERIOD_MS = 5


class Host:
    """Slicer, its scene and one module in it, with the hands and the eyes of a user.

    Attributes:
        scene: `slicer.mrmlScene`.
        widget: the module's widget, once it is opened.
    """

    def __init__(
        self,
        folder: Path,
        module_file: Path = MODULE_FILE,
        connector: bool = True,
        window: bool = True,
    ) -> None:
        """Start Slicer.

        Args:
            folder: for settings, temporary files and Slicer's own folder.
            module_file: of the module.
            connector: whether the extension SlicerOpenIGTLink is installed.
            window: False is Slicer without a main window, as in its generic tests.
        """
        lend_references_to_none()
        appearance.application()
        ANSWERS.clear()
        FAILURES.texts.clear()
        self._home = Home(folder / "home")
        self._application_scene = ApplicationScene()
        self.scene = self._application_scene.scene
        self._module_file = module_file
        self._installation = Installation()
        self._installation.add_modules()
        self._installation.set("mrmlScene", self.scene)
        logic = self._application_scene.applicationLogic
        self._layout = LayoutManager(self.scene, logic)
        layout = self._layout if window else None
        self._installation.set("app", Application(folder, logic, layout))
        if connector:
            self._installation.set("vtkMRMLIGTLConnectorNode", HeadlessConnector)
            self._installation.set("vtkSlicerOpenIGTLinkCommand", HeadlessCommand)
        self._main_window = class_named("qSlicerMainWindow")() if window else None
        self._excepthook, sys.excepthook = sys.excepthook, self._note
        # As the module OpenIGTLinkIF does.
        self._timer = QtCore.QTimer()
        self._timer.setInterval(CONNECTOR_PERIOD_MS)
        self._timer.timeout.connect(self._process_connectors)
        self._timer.start()
        self.widget: Any = None
        self._frame: Any = None
        self._module_name = module_file.stem
        self._load_module()

    @property
    def messages(self) -> list[Message]:
        """The message boxes so far."""
        return ANSWERS.messages

    @property
    def errors(self) -> list[str]:
        """What went wrong where Slicer would have printed it and gone on; empty in a good test."""
        return FAILURES.texts

    # The module's life

    def open(self) -> Any:
        """Open the module, as choosing it in the list of modules does; return its widget."""
        if self.widget is None:
            self._frame = class_named("qSlicerScriptedLoadableModuleWidget")()
            self._frame.setMRMLScene(self.scene)
            module = sys.modules[self._module_name]
            self.widget = getattr(module, f"{self._module_name}Widget")(self._frame)
            self.widget.setup()
            self._frame._qt.resize(430, 900)
            self._frame._qt.show()
        if not self._frame.isEntered:
            self.enter()
        return self.widget

    def enter(self) -> None:
        """Come back to the module."""
        self._frame._qt.enter()
        self.widget.enter()

    def leave(self) -> None:
        """Go to another module."""
        self.widget.exit()
        self._frame._qt.exit()

    def clear_scene(self) -> None:
        """Close the scene, by Slicer's menu."""
        self.scene.Clear(0)
        self.process_events()

    def delete_nodes(self) -> None:
        """Delete each node that the user could delete, one after the other, as in module Data."""
        ids = [self.scene.GetNthNode(i).GetID() for i in range(self.scene.GetNumberOfNodes())]
        for node_id in ids:
            node = self.scene.GetNodeByID(node_id)
            if node is not None and node.GetSingletonTag() is None:
                self.scene.RemoveNode(node)
                self.let_pass(0.12)

    def run_self_tests(self) -> None:
        """Run the module's self tests, as the button Reload and Test does."""
        module = sys.modules[self._module_name]
        getattr(module, f"{self._module_name}Test")().runTest()

    def close(self) -> None:
        """Quit Slicer."""
        try:
            if self.widget is not None:
                self.widget.exit()
                self.widget.cleanup()
                self.process_events()
                self._frame._qt.close()
                self._frame._qt.deleteLater()
                self.widget = self._frame = None
                self.process_events()
        finally:
            self._timer.stop()
            self._layout.close()
            if self._main_window is not None:
                self._main_window._qt.deleteLater()
            self.process_events()
            sys.excepthook = self._excepthook
            self._home.leave()
            sys.modules.pop(self._module_name, None)
            self._installation.remove()

    # What a user does

    def find(self, name: str) -> Any:
        """Return the widget of that name."""
        found = self._frame._qt.findChild(QtCore.QObject, name)
        if found is None:
            raise AssertionError(f"There is no widget {name}.")
        return wrap(found)

    def press(self, name: str) -> None:
        """Press a button; one that is disabled or hidden cannot be pressed."""
        button = self._usable(name)
        QtTest.QTest.mouseClick(
            button, QtCore.Qt.MouseButton.LeftButton, pos=_where_to_press(button)
        )
        self.process_events()

    def choose(self, name: str, choice: Any) -> None:
        """Choose an entry by its text, or a node, in a combo box, list or table row."""
        widget = self._usable(name)
        if hasattr(widget, "setCurrentNode"):
            widget.setCurrentNode(choice)
        elif isinstance(widget, QtWidgets.QComboBox):
            texts = [widget.itemText(index) for index in range(widget.count())]
            index = next((i for i, text in enumerate(texts) if choice in (text, i)), None)
            index = _containing(texts, choice, name) if index is None else index
            widget.setCurrentIndex(index)
            widget.activated.emit(index)
        elif isinstance(widget, QtWidgets.QListWidget):
            texts = [widget.item(row).text() for row in range(widget.count())]
            widget.setCurrentRow(_containing(texts, choice, name))
        elif isinstance(widget, QtWidgets.QTableView):
            widget.selectRow(choice)
        else:
            raise AssertionError(f"Nothing can be chosen in {name}.")
        self.process_events()

    def type(self, name: str, text: str) -> None:
        """Replace the text of an edit, or the path of a path edit, and leave it."""
        widget = self._usable(name)
        if isinstance(widget, QtWidgets.QAbstractSpinBox):
            kind = type(widget.value())
            widget.setValue(kind(text))
        elif hasattr(widget, "setCurrentPath"):
            widget.setCurrentPath(text)
        elif isinstance(widget, QtWidgets.QLineEdit):
            widget.selectAll()
            QtTest.QTest.keyClicks(widget, text) if text else widget.clear()
            widget.editingFinished.emit()
        else:
            widget.setPlainText(text)
        self.process_events()

    def check(self, name: str, checked: bool = True) -> None:
        """Check or uncheck a box."""
        if self._usable(name).isChecked() != checked:
            self._usable(name).click()
        self.process_events()

    def place(self, *position: float) -> None:
        """Click in a view, RAS mm, while Slicer's mouse places points of a markup."""
        interaction = self.scene.GetNodeByID("vtkMRMLInteractionNodeSingleton")
        selection = self.scene.GetNodeByID("vtkMRMLSelectionNodeSingleton")
        if interaction.GetCurrentInteractionMode() != interaction.Place:
            raise AssertionError("The mouse places no points now.")
        node = self.scene.GetNodeByID(selection.GetActivePlaceNodeID())
        node.AddControlPoint(*position)
        isLine = node.IsA("vtkMRMLMarkupsLineNode") and node.GetNumberOfControlPoints() < 2
        if not interaction.GetPlaceModePersistence() and not isLine:
            interaction.SetCurrentInteractionMode(interaction.ViewTransform)
        self.process_events()

    def answer(self, part: str, answer: Any) -> None:
        """Answer the next dialog that says `part`: a button's name, a path, a text, a function."""
        ANSWERS.prepare(part, answer)

    # What a user sees

    def text(self, name: str) -> str:
        """Return the text of a widget."""
        return self.find(name).text

    def wait_until(self, condition: Callable[[], Any], what: str, timeout_s: float = 60.0) -> None:
        """Let events pass until something is so.

        Raises:
            AssertionError: it is not so in time, or something went wrong meanwhile; `what` says
                what was awaited.
        """
        deadline = time.monotonic() + timeout_s
        while not condition():
            self.process_events()
            if self.errors:
                raise AssertionError(f"While waiting until {what}: {self.errors[0]}")
            if time.monotonic() > deadline:
                raise AssertionError(f"In {timeout_s} s it did not happen: {what}.")
            time.sleep(0.002)

    def let_pass(self, seconds: float) -> None:
        """Let some time pass, as a user does who waits."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.process_events()
            time.sleep(0.005)

    def process_events(self) -> None:
        """Let Qt do what is due."""
        QtWidgets.QApplication.processEvents()
        QtWidgets.QApplication.sendPostedEvents(None, QtCore.QEvent.Type.DeferredDelete)

    def screenshot(self, path: Path, name: str | None = None, width: int = 430) -> None:
        """Save a picture of the whole panel, or of one widget in it."""
        self._fit(width)
        widget = self._frame._qt if name is None else self.find(name)._qt
        _save(widget.grab(), path)

    def window_screenshot(self, path: Path, width: int = 430) -> None:
        """Save a picture of Slicer's window: the panel, the 3D view and the slices."""
        self._fit(width)
        _save(pictures.window(self._frame._qt, self._layout), path)

    def look_from(self, azimuth: float, elevation: float, zoom: float = 1.0) -> None:
        """Turn the 3D view, degrees from the front, to all that is visible."""
        self._layout.three_d_view_of_host().look_from(azimuth, elevation, zoom)

    def look_at(self, place: tuple, azimuth: float, elevation: float, distance: float) -> None:
        """Turn the 3D view to a place, RAS mm, from a distance, mm."""
        self._layout.three_d_view_of_host().look_at(place, azimuth, elevation, distance)

    def _fit(self, width: int) -> None:
        """Make the panel as high as its contents; layouts within layouts settle one by one."""
        frame, heights = self._frame._qt, [0, -1]
        while heights[-1] != heights[-2]:
            heights.append(max(frame.layout().totalHeightForWidth(width), 100))
            frame.resize(width, heights[-1])
            for _round in range(5):
                self.process_events()

    def _usable(self, name: str) -> Any:
        self.process_events()  # A widget that has just been added is shown by an event.
        widget = self.find(name)._qt
        if not widget.isEnabled():
            raise AssertionError(f"{name} is disabled: {widget.toolTip()}")
        if not widget.isVisible():
            raise AssertionError(f"{name} is hidden.")
        return widget

    def _load_module(self) -> None:
        name = self._module_name
        spec = importlib.util.spec_from_file_location(name, self._module_file)
        module = importlib.util.module_from_spec(spec)
        sys.modules[name] = module
        spec.loader.exec_module(module)
        description = ModuleDescription(name, self._module_file)
        setattr(slicer.modules, name.lower(), description)
        setattr(slicer.modules, f"{name}Instance", getattr(module, name)(description))

    def _process_connectors(self) -> None:
        for node in slicer.util.getNodesByClass("vtkMRMLScriptedModuleNode"):
            if isinstance(node, HeadlessConnector):
                node.PeriodicProcess()

    def _note(self, _kind: type, exception: BaseException, trace: Any) -> None:
        """VTK and Qt hand what Python raised in their callbacks to this hook."""
        FAILURES.catch(exception.with_traceback(trace))


def _save(picture: QtGui.QPixmap, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    if not picture.save(str(path)):
        raise AssertionError(f"The picture {path} cannot be written.")


def _where_to_press(button: QtWidgets.QWidget) -> QtCore.QPoint:
    return QtCore.QPoint(min(12, button.width() // 2), min(10, button.height() // 2))


def _containing(texts: list[str], choice: str, name: str) -> int:
    for index, text in enumerate(texts):
        if choice in text:
            return index
    raise AssertionError(f"{name} offers no “{choice}”, only: {', '.join(texts)}.")
