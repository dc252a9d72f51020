"""Shared by the steps of the tour: hands, dialogs, separate studies, the trainee's process."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path
from typing import Any

import qt
import slicer
from tour_hands import Hands, TourError

SLIP_AT = 9


class Tour(Hands):
    """The opened module, and someone who works with it."""

    def __init__(self, folder: Path, program: str, has_window: bool, patience_s: float) -> None:
        if slicer.util.mainWindow() is not None:
            slicer.util.selectModule("RASTrainer")
        module = slicer.util.getModuleWidget("RASTrainer")
        self.dialogs = Dialogs()
        super().__init__(module, self.dialogs.unexpected, patience_s)
        self.panel = module.parent
        if slicer.util.mainWindow() is None:
            self.panel.show()
            module.enter()
        self.session = module.logic.session
        self.folder = folder.absolute()
        self.program = program
        self.has_window = has_window
        self._trainee: subprocess.Popen | None = None
        self._former = self._choices()
        folder.mkdir(parents=True, exist_ok=True)

    def close(self) -> None:
        """End the trainee, and restore the user's choices."""
        if self._trainee is not None and self._trainee.poll() is None:
            self._trainee.kill()
        self.dialogs.close()
        for name, attribute, value in self._former:
            setattr(self.find(name), attribute, value)
        self.idle_for(0.3)

    def _choices(self) -> list[tuple[str, str, object]]:
        kept = (
            ("programPathLineEdit", "currentPath"),
            ("studyPathLineEdit", "currentPath"),
            ("windowCheckBox", "checked"),
            ("tutorialCheckBox", "checked"),
        )
        return [(name, what, getattr(self.find(name), what)) for name, what in kept]

    def choose_study(self, path: Path) -> None:
        """Continue with a study in the tour's folder."""
        self.find("studyPathLineEdit").currentPath = str(path)
        self.idle_for(0.2)

    def fresh(self, name: str) -> Path:
        """Return the path of a file in the tour's folder, which is not there yet."""
        path = self.folder / name
        path.unlink(missing_ok=True)
        return path

    def remove_chosen_scenario(self) -> None:
        """Remove the scenario that is chosen and loaded, and go back to the built-in one."""
        combo = self.find("scenarioComboBox")
        name = combo.itemData(combo.currentIndex)
        folder = self.session.places.library / name
        self.must(folder.is_dir(), f"There is no scenario {folder}.")
        # The simulator, which is about to use it, loads one scenario at a time.
        self.play("--await", name)
        self.choose("scenarioComboBox", "Colin27")
        self.click("loadScenarioButton")
        self.play("--await", "colin27")
        shutil.rmtree(folder)

    def place(self, node: Any, *places: tuple[float, ...]) -> None:
        """Place points of a markup, as by clicks in a view."""
        for place in places:
            node.AddControlPoint(*place)
        interaction = slicer.app.applicationLogic().GetInteractionNode()
        interaction.SetCurrentInteractionMode(interaction.ViewTransform)
        self.idle_for(0.5)

    def place_active(self, *places: tuple[float, ...]) -> None:
        """Place points of the markup that the module has just added."""
        selection = slicer.app.applicationLogic().GetSelectionNode()
        self.place(slicer.mrmlScene.GetNodeByID(selection.GetActivePlaceNodeID()), *places)

    def touch(self, first: int, last: int) -> str:
        """Let the trainee touch points, and wait until Slicer shows them; return its sentence."""
        self.play("--points", str(first), str(last), "--slip-at", str(SLIP_AT))
        self.wait_until(lambda: self.find("pointsProgressBar").value == last, "they are shown")
        return self.text("nextStepText")

    def play(self, *words: str) -> None:
        """Let the trainee do something, in a process of Slicer's own Python."""
        places = self.session.places
        command = [str(places.python), str(Path(__file__).with_name("tour_trainee.py"))]
        command += ["--logic", str(Path(self.module.resourcePath("..")) / "Logic")]
        command += ["--scenario", str(places.assets / "scenarios" / "colin27")]
        command += ["--records", str(places.records)]
        command += ["--port", str(self.find("portSpinBox").value)]
        command += ["--patience", str(self.patience_s), *words]
        self._trainee = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
        self.wait_until(lambda: self._trainee.poll() is not None, "the trainee is done")
        said = self._trainee.communicate()[0]
        if self._trainee.returncode != 0:
            raise TourError(f"The scripted trainee has failed: {said}")


LOOK_EVERY_MS = 100
MAX_TRIES = 50


class Dialogs:
    """Presses the buttons of dialogs, by a timer, which runs while a dialog waits for its user."""

    def __init__(self) -> None:
        # The dialogs of the system are not Qt's: their buttons cannot be pressed from here.
        slicer.app.setAttribute(qt.Qt.AA_DontUseNativeDialogs, True)
        self.unexpected: list[str] = []
        self._answers: list[tuple[str, str]] = []
        self._present: tuple[str, str | None] | None = None
        self._tries = 0
        self._timer = qt.QTimer()
        self._timer.setInterval(LOOK_EVERY_MS)
        self._timer.connect("timeout()", self._look)
        self._timer.start()

    def close(self) -> None:
        self._timer.stop()

    def answer(self, part: str, answer: str) -> None:
        """Answer the next dialog whose text or title contains `part`."""
        self._answers.append((part, str(answer)))

    def forget(self) -> None:
        self._answers = []

    def _look(self) -> None:
        dialog = slicer.app.activeModalWidget()
        if dialog is None:
            self._present, self._tries = None, 0
            return
        kind = dialog.className()
        text = f"{dialog.windowTitle} {dialog.text if kind.endswith('MessageBox') else ''}".strip()
        if self._present is None or self._present[0] != text:
            self._present, self._tries = (text, self._take(text)), 0
        self._tries += 1
        answer = self._present[1]
        if answer is None or self._tries > MAX_TRIES:
            self.unexpected.append(text)
            dialog.reject()
        elif kind.endswith("MessageBox"):
            dialog.button(getattr(qt.QMessageBox, answer)).click()
        elif kind == "QFileDialog":
            slicer.util.findChild(dialog, "fileNameEdit").text = answer
            dialog.accept()
        else:
            dialog.setTextValue(answer)
            dialog.accept()

    def _take(self, text: str) -> str | None:
        for prepared in self._answers:
            if prepared[0] in text:
                self._answers.remove(prepared)
                return prepared[1]
        return None
