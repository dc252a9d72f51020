"""Widgets that Qt lacks, or that would wait for a user, made with PySide6.

They are written in PySide6's manner; `proxy` gives them PythonQt's.
"""

from Testing.slicer.host.stand_ins.ctk_buttons import (
    ctkCollapsibleButton,
    ctkCollapsibleGroupBox,
    ctkPushButton,
)
from Testing.slicer.host.stand_ins.ctk_inputs import (
    ctkComboBox,
    ctkDirectoryButton,
    ctkPathLineEdit,
    ctkSliderWidget,
)
from Testing.slicer.host.stand_ins.dialogs import (
    QDesktopServices,
    QDialog,
    QFileDialog,
    QInputDialog,
    QMessageBox,
    ctkMessageBox,
)
from Testing.slicer.host.stand_ins.mrml_widgets import (
    qMRMLTableView,
    qMRMLWidget,
    qSlicerMainWindow,
    qSlicerScriptedLoadableModuleWidget,
)
from Testing.slicer.host.stand_ins.node_combo_box import qMRMLNodeComboBox
from Testing.slicer.host.stand_ins.plot_view import qMRMLPlotView, qMRMLPlotWidget
from Testing.slicer.host.stand_ins.ui_loader import QUiLoader

__all__ = [
    "QDesktopServices",
    "QDialog",
    "QFileDialog",
    "QInputDialog",
    "QMessageBox",
    "QUiLoader",
    "ctkCollapsibleButton",
    "ctkCollapsibleGroupBox",
    "ctkComboBox",
    "ctkDirectoryButton",
    "ctkMessageBox",
    "ctkPathLineEdit",
    "ctkPushButton",
    "ctkSliderWidget",
    "qMRMLNodeComboBox",
    "qMRMLPlotView",
    "qMRMLPlotWidget",
    "qMRMLTableView",
    "qMRMLWidget",
    "qSlicerMainWindow",
    "qSlicerScriptedLoadableModuleWidget",
]
