"""Qt without a screen, looking as Slicer does."""

from __future__ import annotations

import os
import sys

from PySide6 import QtCore, QtGui, QtWidgets

FONTS = ("Noto Sans", "DejaVu Sans", "Liberation Sans")
POINT_SIZE = 9
OFFSCREEN_REMARK = "This plugin does not support propagateSizeHints()"


def application() -> QtWidgets.QApplication:
    os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
    running = QtWidgets.QApplication.instance()
    if running is not None:
        return running
    made = QtWidgets.QApplication(["Slicer"])
    made.setQuitOnLastWindowClosed(False)
    QtCore.qInstallMessageHandler(_pass_on)
    made.setStyle("Fusion")
    families = set(QtGui.QFontDatabase.families())
    font = QtGui.QFont(next((name for name in FONTS if name in families), made.font().family()))
    font.setPointSize(POINT_SIZE)
    made.setFont(font)
    made.setPalette(light_palette())
    return made


def _pass_on(_kind: QtCore.QtMsgType, _context: object, text: str) -> None:
    if text != OFFSCREEN_REMARK:
        print(text, file=sys.stderr)


def light_palette() -> QtGui.QPalette:
    """Return the colors of Slicer's light style."""
    palette = QtGui.QPalette()
    role, group = QtGui.QPalette.ColorRole, QtGui.QPalette.ColorGroup
    gray = QtGui.QColor("#9a9a9a")
    for name, color in {
        role.Window: "#efefef",
        role.Base: "#ffffff",
        role.AlternateBase: "#f7f7f7",
        role.Button: "#efefef",
        role.Text: "#000000",
        role.WindowText: "#000000",
        role.ButtonText: "#000000",
        role.Highlight: "#308cc6",
        role.HighlightedText: "#ffffff",
        role.ToolTipBase: "#ffffdc",
        role.ToolTipText: "#000000",
    }.items():
        palette.setColor(name, QtGui.QColor(color))
    for name in (role.Text, role.WindowText, role.ButtonText):
        palette.setColor(group.Disabled, name, gray)
    return palette
