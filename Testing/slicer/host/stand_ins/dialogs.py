"""Dialogs that would wait for a user: the test has answered them beforehand."""

from __future__ import annotations

from PySide6 import QtCore, QtGui, QtWidgets

from Testing.slicer.host.answers import ANSWERS, Message
from Testing.slicer.host.failures import FAILURES

Buttons = QtWidgets.QMessageBox.StandardButton


class QMessageBox(QtWidgets.QMessageBox):
    """Is shown, and closed by the answer at once."""

    def exec(self) -> int:
        if ANSWERS.are_given_by_hand:
            return super().exec()
        details = QtWidgets.QMessageBox.ButtonRole.ActionRole  # The button Show Details.
        buttons = {
            self._name(button): button
            for button in self.buttons()
            if self.buttonRole(button) != details
        }
        names = list(buttons) or ["Ok"]
        answer = ANSWERS.show(self.windowTitle(), self.text(), self.detailedText(), names)
        if answer not in buttons:
            return Buttons.Ok.value
        buttons[answer].click()
        return self.standardButton(buttons[answer]).value

    def _name(self, button: QtWidgets.QAbstractButton) -> str:
        standard = self.standardButton(button)
        return button.text().replace("&", "") if standard == Buttons.NoButton else standard.name

    # Nothing uses them; they would wait for a user.
    question = information = warning = critical = None


class ctkMessageBox(QMessageBox):
    """A message box with a choice not to show it again; `slicer.util` uses it."""


class QFileDialog(QtWidgets.QFileDialog):
    """Returns the path that the test has chosen, without the filter: so does PythonQt."""

    @staticmethod
    def getOpenFileName(_parent: object = None, caption: str = "", *_more: object) -> str:
        return _path(caption, QtWidgets.QFileDialog.FileMode.ExistingFile)

    @staticmethod
    def getSaveFileName(_parent: object = None, caption: str = "", *_more: object) -> str:
        return _path(caption, QtWidgets.QFileDialog.FileMode.AnyFile)

    @staticmethod
    def getExistingDirectory(_parent: object = None, caption: str = "", *_more: object) -> str:
        return _path(caption, QtWidgets.QFileDialog.FileMode.Directory)


def _path(caption: str, mode: QtWidgets.QFileDialog.FileMode) -> str:
    if not ANSWERS.are_given_by_hand:
        return ANSWERS.path(caption)
    dialog = QFileDialog()
    dialog.setWindowTitle(caption)
    dialog.setOption(QtWidgets.QFileDialog.Option.DontUseNativeDialog)
    dialog.setFileMode(mode)
    if mode == QtWidgets.QFileDialog.FileMode.AnyFile:
        dialog.setAcceptMode(QtWidgets.QFileDialog.AcceptMode.AcceptSave)
    return dialog.selectedFiles()[0] if dialog.exec() else ""


class QInputDialog(QtWidgets.QInputDialog):
    """Returns the text that the test has given; an empty one if it is canceled."""

    @staticmethod
    def getText(
        _parent: object, title: str, label: str, _echo: int = 0, text: str = "", *_more: object
    ) -> str:
        if ANSWERS.are_given_by_hand:
            dialog = QInputDialog()
            dialog.setWindowTitle(title)
            dialog.setLabelText(label)
            dialog.setTextValue(text)
            return dialog.textValue() if dialog.exec() else ""
        answer = ANSWERS.take(title, label)
        if answer is None:
            FAILURES.add(f"No answer was prepared for “{label}”.")
        # The text that the field begins with is the message's details.
        ANSWERS.messages.append(Message(title, label, text, answer or ""))
        return answer or ""


class QDesktopServices(QtGui.QDesktopServices):
    """Opens nothing, but remembers what would have been opened, as a message."""

    @staticmethod
    def openUrl(url: QtCore.QUrl) -> bool:
        ANSWERS.show("QDesktopServices", url.toString(), "", ["Ok"])
        return True
