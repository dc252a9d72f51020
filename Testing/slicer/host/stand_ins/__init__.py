"""Widgets that Qt lacks, or that would wait for a user, made with PySide6.

They are written in PySide6's manner; `proxy` gives them PythonQt's.
"""

# ruff: noqa: F403
from Testing.slicer.host.stand_ins.ctk import *
from Testing.slicer.host.stand_ins.dialogs import *
from Testing.slicer.host.stand_ins.mrml import *
from Testing.slicer.host.stand_ins.ui_loader import *
