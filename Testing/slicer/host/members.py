"""The members of real Slicer's classes, which panels may use.

`slicer_members.json` holds the members measured in Slicer 5.13 (Qt 5.15, PythonQt), by listing each
class's meta-object and `dir()`; `python -m Testing.slicer.host.members full.json` makes it of the
full measurement. `UNMEASURED` adds the few classes that the measurement left out.
"""

from __future__ import annotations

import functools
import json
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

FACTS = json.loads((Path(__file__).parent / "slicer_members.json").read_text(encoding="utf-8"))
MODULES = ("qt", "ctk", "qMRML")


@dataclass(frozen=True)
class Members:
    """What one class has: names of properties and methods, and signatures of signals."""

    properties: frozenset[str]
    signals: frozenset[str]
    methods: frozenset[str]

    @functools.cached_property
    def signatures(self) -> dict[str, list[str]]:
        """The signatures of each signal by its name, those with most arguments first."""
        found: dict[str, list[str]] = {}
        for text in sorted(self.signals, key=_argument_count, reverse=True):
            found.setdefault(text.partition("(")[0], []).append(text)
        return found


def module_of(class_name: str) -> str | None:
    """Return the module that has the class; None if Slicer has no such class."""
    for module in MODULES:
        if class_name in FACTS[module]:
            return module
    return "qt" if class_name in UNMEASURED else None


@functools.cache
def members_of(class_name: str) -> Members:
    """Return what a class has, with what every widget has."""
    if class_name in UNMEASURED:
        base, extra = UNMEASURED[class_name]
        inherited = members_of(base) if base else Members(frozenset(), frozenset(), frozenset())
        return _add(inherited, extra)
    entry = FACTS[module_of(class_name)][class_name]
    own = Members(
        frozenset(entry["properties"]), frozenset(entry["signals"]), frozenset(entry["methods"])
    )
    if entry["widget"] and class_name != "QWidget":
        base = members_of("QWidget")
        own = Members(
            own.properties | base.properties, own.signals | base.signals, own.methods | base.methods
        )
    return own


def _add(members: Members, names: str) -> Members:
    """Add names: `.x` is a property, `x(…)` a signal, any other a method."""
    properties, signals, methods = set(), set(), set()
    for name in names.split():
        if name.startswith("."):
            properties.add(name[1:])
        elif "(" in name:
            signals.add(name)
        else:
            methods.add(name)
    return Members(
        members.properties | properties, members.signals | signals, members.methods | methods
    )


def _argument_count(signature: str) -> int:
    arguments = signature.partition("(")[2].rstrip(")")
    return arguments.count(",") + 1 if arguments else 0


class Checked:
    """Distinguishes what Slicer lacks, whose object has the `measured` members, from what only the
    host does not offer."""

    measured: frozenset[str]
    title: str

    def __getattr__(self, name: str) -> Any:
        if name not in self.measured:
            raise AttributeError(f"Slicer's {self.title} has no {name}.")
        raise NotImplementedError(f"{self.title} has {name}, but the host does not offer it yet.")

    def __setattr__(self, name: str, value: Any) -> None:
        if not name.startswith("_") and name not in self.measured:
            raise AttributeError(f"Slicer's {self.title} has no {name}.")
        super().__setattr__(name, value)


UNMEASURED: dict[str, tuple[str, str]] = {
    "QObject": ("", ".objectName blockSignals children className deleteLater parent property"),
    "QLayout": ("QVBoxLayout", ""),
    "QAbstractButton": ("QPushButton", ""),
    "QAbstractItemView": ("QTableView", ""),
    "QHeaderView": (
        "QFrame",
        ".stretchLastSection .defaultSectionSize .minimumSectionSize"
        " ResizeToContents Stretch Interactive Fixed"
        " setSectionResizeMode setStretchLastSection resizeSection sectionSize hideSection"
        " setSectionHidden setSectionsClickable resizeSections sectionSizeHint count",
    ),
    "QScrollBar": ("QSlider", ""),
    "QFile": ("", "exists open close ReadOnly fileName"),
    "QUiLoader": ("", "load"),
    "QUrl": ("", "fromLocalFile toLocalFile toString isValid"),
    "QCursor": ("", "shape pos"),
    "qSlicerMainWindow": ("QWidget", "statusBar moduleSelector"),
    "QPoint": ("", "x y"),
    "QRect": ("", "x y width height"),
    "QSizePolicy": ("", "Expanding Preferred Fixed Minimum MinimumExpanding Ignored Maximum"),
    "QKeySequence": ("", "toString"),
    "QDesktopServices": ("", "openUrl"),
    "qSlicerScriptedLoadableModuleWidget": ("QWidget", ".isEntered .moduleName setMRMLScene"),
}


_NAMES = {
    "qt": """
        QApplication QCheckBox QColor QComboBox QDialog QDoubleSpinBox QFileDialog QFormLayout
        QFrame QGridLayout QGroupBox QHBoxLayout QIcon QInputDialog QLabel QLineEdit QMessageBox
        QPixmap QPlainTextEdit QProcess QProgressBar QProgressDialog QPushButton QScrollArea
        QSettings QSize QSlider QSpinBox QStandardPaths QTableView QTableWidget QTableWidgetItem
        QTimer QVBoxLayout QWidget
    """,
    "ctk": "ctkCollapsibleButton ctkCollapsibleGroupBox ctkMessageBox ctkPathLineEdit",
    "qMRML": """
        qMRMLNodeComboBox qMRMLPlotWidget qMRMLSliceWidget qMRMLThreeDWidget qMRMLWidget
    """,
}
OFFERED = {module: tuple(names.split()) for module, names in _NAMES.items()}


TARGET = Path(__file__).with_name("slicer_members.json")
APPLICATION = ("slicer.app", "slicer.util", "slicer.app.layoutManager()")


def reduced(full: dict) -> dict:
    """Return the part of the full measurement that the host needs."""
    facts = {"about": full["about"]}
    for module, names in OFFERED.items():
        facts[module] = {name: full[module][name] for name in names}
    return facts | {name: full[name] for name in APPLICATION}


def text_of(facts: dict) -> str:
    """Return JSON with one line a class, so that a change can be read."""
    lines = []
    for key, value in facts.items():
        if isinstance(value, dict):
            classes = (f"  {json.dumps(name)}: {json.dumps(value[name])}" for name in value)
            lines.append(f" {json.dumps(key)}: {{\n" + ",\n".join(classes) + "\n }")
        else:
            lines.append(f" {json.dumps(key)}: {json.dumps(value)}")
    return "{\n" + ",\n".join(lines) + "\n}\n"


if __name__ == "__main__":
    TARGET.write_text(text_of(reduced(json.loads(Path(sys.argv[1]).read_text()))))
