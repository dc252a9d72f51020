"""A small Slicer for tests: it runs the unmodified module on PySide6 and slicer-core."""

from __future__ import annotations

import faulthandler
import importlib.util
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import slicer
from PySide6 import QtCore, QtGui, QtTest, QtWidgets

from rastrainer_headless.command import HeadlessCommand
from rastrainer_headless.connector import HeadlessConnector
from Testing.slicer.host import appearance, event_loop, pictures
from Testing.slicer.host.answers import ANSWERS, Message
from Testing.slicer.host.application import Application
from Testing.slicer.host.event_loop import lend_references_to_none
from Testing.slicer.host.failures import FAILURES, VtkMessages
from Testing.slicer.host.installation import Home, Installation
from Testing.slicer.host.layout import LayoutManager
from Testing.slicer.host.proxy import class_named, wrap
from Testing.slicer.host.renders import RenderCounter
from Testing.slicer.host.scene import ApplicationScene
from Testing.slicer.host.scripted_module import ModuleDescription
from Testing.slicer.host.stand_ins import ctkCollapsibleButton, ctkCollapsibleGroupBox

MODULE_FILE = Path(__file__).parents[3] / "RASTrainer" / "RASTrainer.py"
CONNECTOR_PERIOD_MS = 5
DOCK_WIDTH = 470
TIMEOUT_S = 2.0
"""How long to wait for a widget to become visible."""


class Host:
    """Slicer, its scene and one module in it, with the hands and the eyes of a user.

    Attributes:
        scene: `slicer.mrmlScene`.
        widget: the module's widget, once it is opened.
        clicks: names of the buttons and headers that were clicked, in their order.
        keeps_lock: whether the main thread keeps Python's lock while it waits for events, as in
            Slicer; the threads of a test's own peers then run only now and then.
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
        self.keeps_lock = False
        appearance.application()
        ANSWERS.clear()
        FAILURES.texts.clear()
        self._vtk_messages = VtkMessages()
        self._home = Home(folder / "home")
        self._application_scene = ApplicationScene()
        self.scene = self._application_scene.scene
        self._renders = RenderCounter(self.scene)
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
        if window:
            self._layout.show_views()
            self._main_window._qt.setModuleSelector(self)
            self._main_window._qt.setPicture(self._window_picture)
        self._excepthook, sys.excepthook = sys.excepthook, self._note
        # As the module OpenIGTLinkIF does.
        self._timer = QtCore.QTimer()
        self._timer.setInterval(CONNECTOR_PERIOD_MS)
        self._timer.timeout.connect(self._process_connectors)
        self._timer.start()
        self.widget: Any = None
        self.clicks: list[str] = []
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

    @property
    def renders(self) -> int:
        """How often Slicer would have rendered its views so far."""
        return self._renders.count

    # The module's life

    def open(self) -> Any:
        """Open the module, as choosing it in the list of modules does; return its widget."""
        self.made_widget()
        if not self._frame.isEntered:
            self.enter()
        return self.widget

    def selectModule(self, name: str) -> None:
        """Choose a module by its name, as `slicer.util.selectModule` does."""
        if name == self._module_name:
            self.open()
        elif self._frame is not None and self._frame.isEntered:
            self.leave()

    def enter(self) -> None:
        """Come back to the module."""
        self._frame._qt.enter()
        self.widget.enter()

    def leave(self) -> None:
        """Go to another module."""
        self.widget.exit()
        self._frame._qt.exit()

    def minimize(self, is_minimized: bool = True) -> None:
        """Minimize Slicer's main window, or bring it back."""
        window = self._main_window._qt
        window.showMinimized() if is_minimized else window.showNormal()
        self.process_events()

    def clear_scene(self) -> None:
        """Close the scene, by Slicer's menu."""
        self.scene.Clear(0)
        self.process_events()

    def save_scene(self, path: Path) -> None:
        """Save the scene as a bundle (.mrb), by Slicer's menu."""
        if not slicer.util.saveScene(str(path)):
            raise AssertionError(f"{path} was not written.")

    def load_scene(self, path: Path) -> None:
        """Close the scene and open that of a bundle (.mrb), by Slicer's menu."""
        slicer.util.loadScene(str(path), {"clear": True})
        self.process_events()

    def delete_nodes(self) -> None:
        """Delete each node that the user could delete, one after the other, as in module Data."""
        ids = [self.scene.GetNthNode(i).GetID() for i in range(self.scene.GetNumberOfNodes())]
        for node_id in ids:
            node = self.scene.GetNodeByID(node_id)
            if node is not None and node.GetSingletonTag() is None:
                self.scene.RemoveNode(node)
                self.let_pass(0.12)

    def reload(self) -> Any:
        """Press Reload; return the new widget.

        As `slicer.util.reloadScriptedModule` does: the module's own file is read anew, but nothing
        that it imports; what is in the frame is hidden, not deleted, and a new widget is laid in.
        """
        self.made_widget()
        self._execute_module()
        frame = self._frame._qt
        for child in frame.children():
            if isinstance(child, QtWidgets.QWidget):
                child.hide()
        self.widget.cleanup()
        while frame.layout().count():
            frame.layout().takeAt(0)
        self._set_up_widget()
        self.process_events()
        return self.widget

    def run_self_tests(self) -> None:
        """Run the module's self tests, as the button Reload and Test does."""
        module = sys.modules[self._module_name]
        getattr(module, f"{self._module_name}Test")().runTest()

    def run_script(self, path: Path, *arguments: str) -> int | None:
        """Run a script as `Slicer --python-script` does; return with which status it ends Slicer.

        A dialog stays open until the script presses one of its buttons.
        """
        ANSWERS.are_given_by_hand = True
        former = sys.argv
        sys.argv = [str(path), *arguments]
        sys.path.insert(0, str(path.parent))
        # As in Slicer, the event loop of the application is around it.
        loop = QtCore.QEventLoop()
        QtCore.QTimer.singleShot(0, lambda: (_execute(path), loop.quit()))
        try:
            loop.exec()
        finally:
            sys.argv = former
            sys.path.remove(str(path.parent))
            ANSWERS.are_given_by_hand = False
        return slicer.app.exit_status_of_host()

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
            slicer.app.settings().sync()
            self._layout.close()
            if self._main_window is not None:
                self._main_window._qt.deleteLater()
            self.process_events()
            sys.excepthook = self._excepthook
            self._home.leave()
            sys.modules.pop(self._module_name, None)
            slicer.app.close_of_host()
            self._installation.remove()
            self._vtk_messages.close()

    # What a user does

    def find(self, name: str) -> Any:
        """Return the widget of that name."""
        found = self._frame._qt.findChild(QtCore.QObject, name)
        if found is None:
            raise AssertionError(f"There is no widget {name}.")
        return wrap(found)

    def press(self, name: str) -> None:
        """Press a button; one that is disabled or hidden cannot be pressed."""
        self._click(self._usable(name))

    def choose(self, name: str, choice: Any) -> None:
        """Choose an entry by its text, or a node, in a combo box, list or table row."""
        widget = self._usable(name)
        if hasattr(widget, "setCurrentNode"):
            widget.setCurrentNode(choice)
        elif isinstance(widget, QtWidgets.QComboBox):
            texts = [widget.itemText(index) for index in range(widget.count())]
            index = next((i for i, text in enumerate(texts) if choice in (text, i)), None)
            index = _containing(texts, choice, name) if index is None else index
            widget.hidePopup()
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
                faulthandler.dump_traceback(file=sys.__stderr__)
                raise AssertionError(f"In {timeout_s} s it did not happen: {what}. {self._now()}")
            self._wait()

    def _now(self) -> str:
        """Return what may explain why nothing happens."""
        told = [message.text for message in self.messages]
        work = None if self.widget is None else vars(self.widget.logic.session.work)
        return (
            f"Messages: {told}. Work: {work}. The scene is being processed as a batch: "
            f"{bool(self.scene.IsBatchProcessing())}. Clicks: {self.clicks}."
        )

    def let_pass(self, seconds: float) -> None:
        """Let some time pass, as a user does who waits."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.process_events()
            self._wait()

    def process_events(self) -> None:
        """Let Qt do what is due."""
        if self.keeps_lock:
            event_loop.process_events_keeping_lock()
        else:
            QtWidgets.QApplication.processEvents()
        QtWidgets.QApplication.sendPostedEvents(None, QtCore.QEvent.Type.DeferredDelete)

    def _wait(self) -> None:
        """Wait for the next event."""
        if self.keeps_lock:
            event_loop.wait_keeping_lock()
        else:
            time.sleep(0.002)

    def sees(self, model: Any) -> bool:
        """Return whether the whole model is within the 3D view."""
        return self._layout.three_d_view_of_host().sees(model)

    def shown_tables(self) -> list[str]:
        """Return the names of the tables that are seen in the layout's views."""
        return self._layout.shown_tables_of_host()

    def legends(self) -> dict[str, list[tuple[str, float]]]:
        """Return, by view, the title of each color legend that is drawn, and its share of it."""
        views = [self._layout.three_d_view_of_host(), *self._layout.slice_views_of_host()]
        return {view.node.GetName(): view.legends(self.scene) for view in views}

    def screenshot(self, path: Path, name: str | None = None, width: int = 430) -> None:
        """Save a picture of the whole panel, or of one widget in it."""
        self._fit(width)
        widget = self._frame._qt if name is None else self.find(name)._qt
        _save(widget.grab(), path)

    def window_screenshot(self, path: Path, width: int = 430) -> None:
        """Save a picture of Slicer's window: the panel, the 3D view and the slices."""
        _save(self._window_picture(width), path)

    def _window_picture(self, width: int = DOCK_WIDTH) -> QtGui.QPixmap:
        self._fit(width)
        return pictures.window(self._frame._qt, self._layout)

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
            self._settle()

    def unfold(self, name: str) -> None:
        """Open the folded sections and groups around a widget, by clicks on their headers."""
        self.process_events()
        folds, inner = [], self.find(name)._qt
        while inner is not None:
            if isinstance(inner, (ctkCollapsibleButton, ctkCollapsibleGroupBox)):
                folds.append(inner)
            inner = inner.parentWidget()
        for fold in reversed(folds):
            if fold.collapsed:
                self._click(fold)
                self._settle()

    def minimum_width(self) -> int:
        """Return the width, pixels, below which Slicer cannot make the dock of the module."""
        self._settle()
        return self._frame._qt.minimumSizeHint().width()

    def _settle(self) -> None:
        """Let layouts within layouts settle one by one."""
        for _round in range(5):
            self.process_events()

    def _click(self, widget: Any) -> None:
        self.clicks.append(widget.objectName())
        clicks: list[bool] = []
        if isinstance(widget, QtWidgets.QAbstractButton):
            widget.clicked.connect(lambda *_checked: clicks.append(True))
        QtTest.QTest.mouseClick(
            widget, QtCore.Qt.MouseButton.LeftButton, pos=_where_to_press(widget)
        )
        if isinstance(widget, QtWidgets.QAbstractButton) and not clicks:
            raise AssertionError(
                f"The click on {widget.objectName()}, {widget.rect()}, was lost: enabled "
                f"{widget.isEnabled()}, visible {widget.isVisible()}, down {widget.isDown()}."
            )
        self.process_events()

    def _usable(self, name: str) -> Any:
        """Return a widget, in a section that is open: a user opens the one that is needed."""
        self.unfold(name)
        deadline = time.monotonic() + TIMEOUT_S
        # One that has just been made anew or unfolded is shown by an event. Slicer's panel scrolls:
        # no widget is squeezed to nothing where many sections are open.
        while not _has_area(self.find(name)._qt) and time.monotonic() < deadline:
            self._fit(DOCK_WIDTH)
            self.unfold(name)
        widget = self.find(name)._qt
        if not widget.isEnabled():
            raise AssertionError(f"{name} is disabled: {widget.toolTip()}")
        if not _has_area(widget):
            raise AssertionError(f"{name} is hidden, or {widget.rect()} shows nothing of it.")
        return widget

    def made_widget(self) -> Any:
        """Return the module's widget; if its `setup` raises, Slicer prints that and continues."""
        if self.widget is None:
            self._frame = class_named("qSlicerScriptedLoadableModuleWidget")()
            self._frame.setMRMLScene(self.scene)
            self._set_up_widget()
            self._frame._qt.resize(430, 900)
            self._frame._qt.show()
        return self.widget

    def _set_up_widget(self) -> None:
        module = sys.modules[self._module_name]
        self.widget = getattr(module, f"{self._module_name}Widget")(self._frame)
        setattr(slicer.modules, f"{self._module_name}Widget", self.widget)
        try:
            self.widget.setup()
        except Exception as exception:
            FAILURES.catch(exception)

    def _execute_module(self) -> ModuleType:
        """Read the module's file, as if for the first time."""
        name = self._module_name
        spec = importlib.util.spec_from_file_location(name, self._module_file)
        module = importlib.util.module_from_spec(spec)
        sys.modules[name] = module
        spec.loader.exec_module(module)
        return module

    def _load_module(self) -> None:
        name, module = self._module_name, self._execute_module()
        description = ModuleDescription(name, self._module_file, self.made_widget)
        slicer.app.moduleManager().add(description)
        setattr(slicer.modules, name.lower(), description)
        setattr(slicer.modules, f"{name}Instance", getattr(module, name)(description))
        slicer.app._complete_startup()

    def _process_connectors(self) -> None:
        for node in slicer.util.getNodesByClass("vtkMRMLScriptedModuleNode"):
            if isinstance(node, HeadlessConnector):
                node.PeriodicProcess()

    def _note(self, _kind: type, exception: BaseException, trace: Any) -> None:
        """VTK and Qt hand what Python raised in their callbacks to this hook."""
        FAILURES.catch(exception.with_traceback(trace))


def _execute(script: Path) -> None:
    code = compile(script.read_text(encoding="utf-8"), str(script), "exec")
    try:
        exec(code, {"__name__": "__main__", "__file__": str(script)})
    except Exception as exception:  # Slicer prints it, and goes on.
        FAILURES.catch(exception)


def _save(picture: QtGui.QPixmap, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    if not picture.save(str(path)):
        raise AssertionError(f"The picture {path} cannot be written.")


def _has_area(widget: QtWidgets.QWidget) -> bool:
    return widget.isVisible() and not widget.rect().isEmpty()


def _where_to_press(button: QtWidgets.QWidget) -> QtCore.QPoint:
    if isinstance(button, QtWidgets.QGroupBox):
        option = QtWidgets.QStyleOptionGroupBox()
        button.initStyleOption(option)
        kinds = QtWidgets.QStyle
        kind, part = kinds.ComplexControl.CC_GroupBox, kinds.SubControl.SC_GroupBoxCheckBox
        return button.style().subControlRect(kind, option, part, button).center()
    return QtCore.QPoint(min(12, button.width() // 2), min(10, button.height() // 2))


def _containing(texts: list[str], choice: str, name: str) -> int:
    for index, text in enumerate(texts):
        if choice in text:
            return index
    raise AssertionError(f"{name} offers no “{choice}”, only: {', '.join(texts)}.")
