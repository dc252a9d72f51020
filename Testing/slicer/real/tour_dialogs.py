"""Answers the dialogs that the module opens: nobody sits at the tour."""

from __future__ import annotations

import qt
import slicer

LOOK_EVERY_MS = 100
MOST_TRIES = 50


class Dialogs:
    """Presses the buttons of dialogs, by a timer, which runs while a dialog waits for its user.

    Attributes:
        unexpected: what dialogs said for which no answer was prepared; they are canceled.
    """

    def __init__(self) -> None:
        # The dialogs of the system are not Qt's: nobody could press their buttons from here.
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
        """Answer no more."""
        self._timer.stop()

    def answer(self, part: str, answer: str) -> None:
        """Answer the next dialog whose text or title contains `part`.

        Args:
            part: of the text or of the title.
            answer: name of a button of a question, a path for a file dialog, or a text.
        """
        self._answers.append((part, str(answer)))

    def forget(self) -> None:
        """Forget the answers that nothing has asked for."""
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
        if answer is None or self._tries > MOST_TRIES:
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
