"""A small Slicer for tests: it runs the unmodified module on PySide6 and slicer-core."""

from __future__ import annotations

import importlib.util
import shutil
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import slicer
from PySide6 import QtCore, QtWidgets

from rastrainer_headless.connector import HeadlessCommand, HeadlessConnector
from Testing.slicer.host import appearance
from Testing.slicer.host.answers import ANSWERS, Message
from Testing.slicer.host.application import Application
from Testing.slicer.host.event_loop import lend_references
from Testing.slicer.host.failures import FAILURES, VtkMessages
from Testing.slicer.host.installation import Installation
from Testing.slicer.host.layout import LayoutManager
from Testing.slicer.host.proxy import class_named
from Testing.slicer.host.renders import RenderCounter
from Testing.slicer.host.scene import ApplicationScene
from Testing.slicer.host.scripted_module import ModuleDescription
from Testing.slicer.host.user import User

MODULE_FILE = Path(__file__).parents[3] / "RASTrainer" / "RASTrainer.py"
CONNECTOR_PERIOD_MS = 5


class Host(User):
    """Slicer, its scene and one module in it, with the hands and the eyes of a user."""

    def __init__(
        self,
        folder: Path,
        module_file: Path = MODULE_FILE,
        connector: bool = True,
        window: bool = True,
    ) -> None:
        lend_references()
        self.keeps_lock = False
        appearance.application()
        ANSWERS.clear()
        FAILURES.texts.clear()
        self._vtk_messages = VtkMessages()
        self._installation = Installation(folder / "home")
        self._application_scene = ApplicationScene()
        self.scene = self._application_scene.scene
        self._renders = RenderCounter(self.scene)
        self._module_file = module_file
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
            self._main_window._qt.selector = self
            self._main_window._qt.picture = self._window_picture
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
        return ANSWERS.messages

    @property
    def errors(self) -> list[str]:
        """Errors that Slicer would have only printed; empty in a good test."""
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
        self._frame._qt.enter()
        self.widget.enter()

    def leave(self) -> None:
        self.widget.exit()
        self._frame._qt.exit()

    def minimize(self, is_minimized: bool = True) -> None:
        """Minimize Slicer's main window, or restore it."""
        window = self._main_window._qt
        window.showMinimized() if is_minimized else window.showNormal()
        self.process_events()

    def begin_anew(self, study: Path) -> None:
        """Reset the open module, and continue with another study."""
        ANSWERS.clear()
        FAILURES.texts.clear()
        session = self.widget.logic.session
        # The next simulator may report no trial.
        session.link.stateChanged.emit({})
        shutil.rmtree(session.places.records, ignore_errors=True)
        self.clear_scene()
        self.find("hostLineEdit").text = "127.0.0.1"
        for name in ("programPathLineEdit", "wheelsPathLineEdit"):
            self.find(name).currentPath = ""
        self.find("studyPathLineEdit").currentPath = str(study)
        self.finish_work()

    def clear_scene(self) -> None:
        """Close the scene, by Slicer's menu."""
        self.scene.Clear(0)
        self.process_events()

    def save_scene(self, path: Path) -> None:
        """Save the scene as a bundle (.mrb), by Slicer's menu."""
        if not slicer.util.saveScene(str(path)):
            raise AssertionError(f"{path} was not written.")

    def load_scene(self, path: Path) -> None:
        """Close the scene and open the scene of a bundle (.mrb), by Slicer's menu."""
        slicer.util.loadScene(str(path), {"clear": True})
        self.process_events()

    def delete_nodes(self) -> None:
        """Delete each node that the user could delete, one after the other, as in module Data."""
        ids = [self.scene.GetNthNode(i).GetID() for i in range(self.scene.GetNumberOfNodes())]
        for node_id in ids:
            node = self.scene.GetNodeByID(node_id)
            if node is not None and node.GetSingletonTag() is None:
                self.scene.RemoveNode(node)
                self.idle_for(0.12)

    def reload(self) -> Any:
        """Press Reload; return the new widget.

        As `slicer.util.reloadScriptedModule` does: the module's own file is read anew, but nothing
        that it imports; the former widget in the frame is hidden, not deleted.
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
        """Run a script as `Slicer --python-script` does; return Slicer's exit status.

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
            sys.modules.pop(self._module_name, None)
            slicer.app.close_of_host()
            self._installation.remove()
            self._vtk_messages.close()

    def made_widget(self) -> Any:
        """Return the module's widget; if its `setup` raises, Slicer prints that and continues.

        As a user does, it waits until the widget is built.
        """
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
        building = getattr(self.widget, "_building", None)
        while building is not None and not building.isOver:
            self.process_events()

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
        """VTK and Qt pass exceptions in their callbacks to this hook."""
        FAILURES.catch(exception.with_traceback(trace))


def _execute(script: Path) -> None:
    code = compile(script.read_text(encoding="utf-8"), str(script), "exec")
    try:
        exec(code, {"__name__": "__main__", "__file__": str(script)})
    except Exception as exception:  # Slicer prints it, and continues.
        FAILURES.catch(exception)
