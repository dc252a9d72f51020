"""What the steps of the tour share: hands, dialogs, studies of its own, the trainee's process."""

from __future__ import annotations

import subprocess
from pathlib import Path

import slicer
from tour_dialogs import Dialogs
from tour_hands import Hands, TourError

SLIP_AT = 9


class Tour:
    """The module, opened, with somebody who works it.

    Attributes:
        hands: work the widgets.
        dialogs: answer what the module asks.
        panel: the module's widget.
        session: what the module keeps while it is loaded.
        folder: of all that is written.
        program: a simulator that is installed elsewhere, empty for the module's own.
        has_window: whether the trainee's window is opened.
    """

    def __init__(self, folder: Path, program: str, has_window: bool) -> None:
        """Open the module."""
        if slicer.util.mainWindow() is not None:
            slicer.util.selectModule("RASTrainer")
        module = slicer.util.getModuleWidget("RASTrainer")
        self.dialogs = Dialogs()
        self.hands = Hands(module, self.dialogs.unexpected)
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
        """End the trainee, and give the user's choices back."""
        if self._trainee is not None and self._trainee.poll() is None:
            self._trainee.kill()
        self.dialogs.close()
        for name, attribute, value in self._former:
            setattr(self.hands.find(name), attribute, value)
        self.hands.let_pass(0.3)

    def _choices(self) -> list[tuple[str, str, object]]:
        kept = (
            ("programPathLineEdit", "currentPath"),
            ("studyPathLineEdit", "currentPath"),
            ("windowCheckBox", "checked"),
        )
        return [(name, what, getattr(self.hands.find(name), what)) for name, what in kept]

    def choose_study(self, path: Path) -> None:
        """Go on with a study in the tour's folder."""
        self.hands.find("studyPathLineEdit").currentPath = str(path)
        self.hands.let_pass(0.2)

    def fresh(self, name: str) -> Path:
        """Return the path of a file in the tour's folder, which is not there yet."""
        path = self.folder / name
        path.unlink(missing_ok=True)
        return path

    def touch(self, first: int, last: int) -> str:
        """Let the trainee touch points, and wait until Slicer shows them; return what it says."""
        hands = self.hands
        self.play("--points", str(first), str(last), "--slip-at", str(SLIP_AT))
        hands.wait_until(lambda: hands.find("pointsProgressBar").value == last, "they are shown")
        return hands.text("nextStepText")

    def play(self, *words: str) -> None:
        """Let the trainee do something, in a process of Slicer's own Python."""
        places = self.session.places
        command = [str(places.python), str(Path(__file__).with_name("tour_trainee.py"))]
        command += ["--logic", str(Path(self.hands.module.resourcePath("..")) / "Logic")]
        command += ["--scenario", str(places.assets / "scenarios" / "colin27")]
        command += ["--records", str(places.records)]
        command += ["--port", str(self.hands.find("portSpinBox").value), *words]
        self._trainee = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
        self.hands.wait_until(lambda: self._trainee.poll() is not None, "the trainee is done")
        said = self._trainee.communicate()[0]
        if self._trainee.returncode != 0:
            raise TourError(f"The scripted trainee has failed: {said}")
