"""The sections fit into the dock that Slicer has on a laptop."""

import xml.etree.ElementTree as ElementTree
from pathlib import Path

UI = Path(__file__).parents[2] / "RASTrainer" / "Resources" / "UI"
DOCK_WIDTH = 472
"""Pixels; a module that asks for more widens the dock and takes the room of the views."""

LIMIT = 0.9 * DOCK_WIDTH
"""Fonts and styles of other systems are wider than those of the host."""


def named(class_name):
    return [
        widget.get("name")
        for path in sorted(UI.glob("*.ui"))
        for widget in ElementTree.parse(path).iter("widget")
        if widget.get("class") == class_name
    ]


SECTIONS, GROUPS = named("ctkCollapsibleButton"), named("ctkCollapsibleGroupBox")
PATHS = named("ctkPathLineEdit")


def test_a_section_opened_with_all_its_groups_does_not_widen_the_dock(host):
    host.open()
    for group in GROUPS:
        host.find(group).collapsed = False
    for opened in SECTIONS:
        for section in SECTIONS:
            host.find(section).collapsed = section != opened
        assert host.minimum_width() <= LIMIT, opened


def test_all_sections_at_once_do_not_widen_the_dock(host):
    host.open()
    for name in SECTIONS + GROUPS:
        host.find(name).collapsed = False
    assert host.minimum_width() <= LIMIT


def test_long_names_of_nodes_and_paths_do_not_widen_the_dock(host):
    host.open()
    for class_name in ("vtkMRMLMarkupsFiducialNode", "vtkMRMLModelNode", "vtkMRMLScalarVolumeNode"):
        host.scene.AddNewNodeByClass(class_name, "A name as long as a file's path " * 9)
    for name in PATHS:
        host.find(name).currentPath = "/a folder with a long name" * 9
    for name in SECTIONS + GROUPS:
        host.find(name).collapsed = False
    assert host.minimum_width() <= LIMIT
