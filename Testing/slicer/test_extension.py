"""What Slicer's Extensions Manager installs: complete, importable, following its conventions."""

import ast
import json
import re
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MODULE = ROOT / "RASTrainer"
SOURCES = sorted(MODULE.rglob("*.py"))
RESOURCES = sorted(
    path
    for path in MODULE.rglob("*.*")
    if path.parts[-2] != MODULE.name
    and path.suffix not in (".py", ".pyc")
    and ".whl" not in path.name
)
"""Without the simulator's wheel, which a release builds."""

# Importable in Slicer: its modules, and packages of its Python.
BUNDLED = {"slicer", "vtk", "qt", "ctk", "numpy", "scipy", "requests", "PIL", "SampleData"}


def relative(paths):
    return sorted(path.relative_to(MODULE).as_posix() for path in paths)


def listed(variable):
    text = (MODULE / "CMakeLists.txt").read_text()
    block = re.search(rf"set\({variable}\n(.*?)\n  \)", text, re.DOTALL).group(1)
    return sorted(
        line.strip().replace("${MODULE_NAME}", "RASTrainer") for line in block.splitlines()
    )


def imported_packages(path):
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name.partition(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield node.module.partition(".")[0]


UI_FILES = sorted((MODULE / "Resources" / "UI").glob("*.ui"))


def widgets():
    trees = [ElementTree.parse(path) for path in UI_FILES]
    return {widget.get("name"): widget for tree in trees for widget in tree.iter("widget")}


def test_every_python_file_is_listed_in_cmake():
    assert listed("MODULE_PYTHON_SCRIPTS") == relative(SOURCES)


def test_every_resource_is_listed_in_cmake():
    assert listed("MODULE_PYTHON_RESOURCES") == relative(RESOURCES)


def test_every_python_file_compiles_under_the_oldest_supported_version():
    for path in SOURCES:
        ast.parse(path.read_text(encoding="utf-8"), str(path), feature_version=(3, 10))


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.relative_to(MODULE).as_posix())
def test_nothing_is_imported_that_does_not_ship_with_slicer(path):
    allowed = {*sys.stdlib_module_names, *BUNDLED, "rastrainer"}
    if path.match("igtl/message.py"):
        allowed.add("fastcrc")  # Guarded: without it, the checksum is plain Python.
    assert set(imported_packages(path)) <= allowed


def test_the_module_file_holds_definitions_only():
    allowed = (ast.Import, ast.ImportFrom, ast.ClassDef, ast.FunctionDef)
    body = ast.parse((MODULE / "RASTrainer.py").read_text()).body
    others = [node for node in body if not isinstance(node, allowed)]
    assert all(isinstance(n, ast.If) and ast.unparse(n.test) == "TYPE_CHECKING" for n in others)


def test_the_module_does_not_vanish_without_the_connector():
    source = (MODULE / "RASTrainer.py").read_text()
    assert "parent.dependencies = []" in source
    assert "vtkMRMLIGTLConnectorNode" not in source
    assert "def runTest" not in source


def test_the_extension_names_category_and_dependency():
    text = (ROOT / "CMakeLists.txt").read_text()
    assert 'set(EXTENSION_CATEGORY "Training")' in text
    assert 'set(EXTENSION_DEPENDS "SlicerOpenIGTLink")' in text


def test_the_catalog_entry_follows_the_rules_of_slicers_extensions_index():
    """The rules come from Slicer's schema of a catalog entry, version 1.0.1, and its template.

    The extension's name is the file's; the repository's begins with "Slicer".
    """
    entry = json.loads((ROOT / "RASTrainer.json").read_text(encoding="utf-8"))
    texts = {"$schema", "category", "scm_url", "scm_revision", "build_subdirectory"}
    assert set(entry) == texts | {"build_dependencies", "tier"}
    assert all(isinstance(entry[name], str) and entry[name] for name in texts)
    assert entry["$schema"].endswith("slicer-extension-catalog-entry-schema-v1.0.1.json#")
    assert re.fullmatch(r"https://\S+/Slicer\w+\.git", entry["scm_url"])
    assert type(entry["tier"]) is int
    assert 1 <= entry["tier"] <= 5
    text = (ROOT / "CMakeLists.txt").read_text()
    assert "project(RASTrainer" in text
    assert f'set(EXTENSION_CATEGORY "{entry["category"]}")' in text
    assert f'set(EXTENSION_DEPENDS "{" ".join(entry["build_dependencies"])}")' in text
    assert entry["scm_url"].removesuffix(".git") in text


def test_the_title_does_not_say_ras_which_means_right_anterior_superior_to_slicer_users():
    source = (MODULE / "RASTrainer.py").read_text(encoding="utf-8")
    (title,) = re.findall(r'parent\.title = _\("(.*)"\)', source)
    assert "Robot-Assisted Surgery" in title
    assert not re.search(r"\bRAS", title)


def test_the_panels_use_only_widgets_that_the_ui_file_has():
    used = set()
    for path in (MODULE / "Logic" / "rastrainer" / "sections").glob("*.py"):
        used |= set(re.findall(r"\bui\.(\w+)", path.read_text()))
    assert used
    assert used <= set(widgets())


def test_no_two_widgets_share_a_name():
    trees = [ElementTree.parse(path) for path in UI_FILES]
    names = [widget.get("name") for tree in trees for widget in tree.iter("widget")]
    assert len(names) == len(set(names))


def test_every_panel_has_a_ui_file_with_its_name():
    source = (MODULE / "Logic" / "rastrainer" / "sections" / "panel_stack.py").read_text()
    panels = ["NextStepPanel", *re.findall(r"^    (\w+Panel),$", source, re.MULTILINE)]
    files = [path.stem for path in UI_FILES if path.stem != "RASTrainer"]
    assert sorted(f"RASTrainer{name}" for name in panels) == sorted(files)


def test_widgets_bound_to_parameters_name_parameters_that_exist():
    module = ast.parse((MODULE / "RASTrainer.py").read_text())
    (parameters,) = (
        {item.target.id for item in node.body if isinstance(item, ast.AnnAssign)}
        for node in module.body
        if isinstance(node, ast.ClassDef) and node.name == "RASTrainerParameterNode"
    )
    bound = {
        item.find("string").text
        for widget in widgets().values()
        for item in widget.findall("property")
        if item.get("name") == "SlicerParameterName"
    }
    assert bound == parameters


def test_the_top_widget_passes_on_the_scene():
    for path in UI_FILES:
        assert ElementTree.parse(path).find("widget").get("class") == "qMRMLWidget"


def test_the_icon_is_a_square_png_of_128_pixels():
    header = (MODULE / "Resources" / "Icons" / "RASTrainer.png").read_bytes()[:24]
    assert header.startswith(b"\x89PNG")
    assert (int.from_bytes(header[16:20], "big"), int.from_bytes(header[20:24], "big")) == (
        128,
        128,
    )
