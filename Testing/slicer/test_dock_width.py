"""The sections fit into the dock that Slicer has on a laptop."""

import xml.etree.ElementTree as ElementTree
from itertools import pairwise
from pathlib import Path

UI = Path(__file__).parents[2] / "RASTrainer" / "Resources" / "UI"
DOCK_WIDTH, WIDEST = 472, 480
"""Pixels; a module that asks for more widens the dock and takes the room of the views."""

LIMIT = 0.9 * DOCK_WIDTH
"""Fonts and styles of other systems are wider than the host's."""


def named(class_name):
    return [
        widget.get("name")
        for path in sorted(UI.glob("*.ui"))
        for widget in ElementTree.parse(path).iter("widget")
        if widget.get("class") == class_name
    ]


SECTIONS, GROUPS = named("ctkCollapsibleButton"), named("ctkCollapsibleGroupBox")
PATHS, TABLES = named("ctkPathLineEdit"), named("QTableWidget")
TEXTS = [name for name in named("QLabel") if name.endswith("Text")]


def open_only(host, opened):
    """Open a section and the section around it, and close the others."""
    around = {"curriculumCollapsibleButton": "studyCollapsibleButton"}.get(opened)
    for section in SECTIONS:
        host.find(section).collapsed = section not in (opened, around)


def fill(host):
    """Fill the tables that are seen, and all texts, as much as a long study would."""
    from rastrainer.widgets.controls import fillTable, setText

    for name in TABLES:
        table = host.find(name)
        if table.isVisible():
            fillTable(table, [["trial 3 of somebody"] * table.columnCount] * 12)
    for name in TEXTS:
        setText(host.find(name), "A sentence that says what happened. " * 12)


def test_sections_that_are_opened_filled_and_closed_fit_without_gaps_also_with_long_names(host):
    host.open()
    for group in GROUPS:
        host.find(group).collapsed = False
    for opened in SECTIONS:
        open_only(host, opened)
        for width in (host.minimum_width(), DOCK_WIDTH):
            assert host.cut_off(width) == [], (opened, width)
        fill(host)
        assert host.width() <= WIDEST, opened
    open_only(host, None)
    assert host.cut_off(DOCK_WIDTH) == []
    sections = [host.find(name)._qt for name in SECTIONS]
    places = [each.mapToGlobal(each.rect().topLeft()) for each in sections if each.isVisible()]
    rows = sorted(place.y() for place in places)
    (height,) = {each.height() for each in sections if each.isVisible()}
    gaps = [lower - upper - height for upper, lower in pairwise(rows)]
    assert max(gaps) <= 4, gaps
    for class_name in ("vtkMRMLMarkupsFiducialNode", "vtkMRMLModelNode", "vtkMRMLScalarVolumeNode"):
        host.scene.AddNewNodeByClass(class_name, "A name as long as a file's path " * 9)
    for name in PATHS:
        host.find(name).currentPath = "/a folder with a long name" * 9
    for name in SECTIONS:
        host.find(name).collapsed = False
    assert host.minimum_width() <= LIMIT
