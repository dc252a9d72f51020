"""Widgets that Qt lacks, or that would wait for a user, made with PySide6.

They are written in PySide6's manner; `proxy` gives them PythonQt's.
"""

from Testing.slicer.host.stand_ins.ctk_buttons import ctkCollapsibleButton as ctkCollapsibleButton
from Testing.slicer.host.stand_ins.ctk_buttons import (
    ctkCollapsibleGroupBox as ctkCollapsibleGroupBox,
)
from Testing.slicer.host.stand_ins.ctk_inputs import ctkPathLineEdit as ctkPathLineEdit
from Testing.slicer.host.stand_ins.dialogs import QDesktopServices as QDesktopServices
from Testing.slicer.host.stand_ins.dialogs import QFileDialog as QFileDialog
from Testing.slicer.host.stand_ins.dialogs import QInputDialog as QInputDialog
from Testing.slicer.host.stand_ins.dialogs import QMessageBox as QMessageBox
from Testing.slicer.host.stand_ins.dialogs import ctkMessageBox as ctkMessageBox
from Testing.slicer.host.stand_ins.mrml_widgets import qMRMLWidget as qMRMLWidget
from Testing.slicer.host.stand_ins.mrml_widgets import qSlicerMainWindow as qSlicerMainWindow
from Testing.slicer.host.stand_ins.mrml_widgets import (
    qSlicerScriptedLoadableModuleWidget as qSlicerScriptedLoadableModuleWidget,
)
from Testing.slicer.host.stand_ins.node_combo_box import qMRMLNodeComboBox as qMRMLNodeComboBox
from Testing.slicer.host.stand_ins.ui_loader import QUiLoader as QUiLoader
