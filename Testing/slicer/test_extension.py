"""What Slicer's Extensions Manager installs: complete, importable, following its conventions."""

import ast
import json
import re
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

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


def test_every_python_file_and_every_resource_is_listed_in_cmake():
    assert listed("MODULE_PYTHON_SCRIPTS") == relative(SOURCES)
    assert listed("MODULE_PYTHON_RESOURCES") == relative(RESOURCES)


def test_nothing_is_imported_that_does_not_ship_with_slicer():
    allowed = {*sys.stdlib_module_names, *BUNDLED, "rastrainer"}
    imported = {(path.name, name) for path in SOURCES for name in imported_packages(path)}
    others = {each for each in imported if each[1] not in allowed}
    # Guarded: without it, the checksum is plain Python.
    assert others == {("message.py", "fastcrc")}


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


def test_the_panels_use_only_widgets_that_a_ui_file_has_and_no_two_share_a_name():
    used = set()
    for path in (MODULE / "Logic" / "rastrainer" / "sections").glob("*.py"):
        used |= set(re.findall(r"\bui\.(\w+)", path.read_text()))
    assert used
    names = [
        widget.get("name")
        for path in (MODULE / "Resources" / "UI").glob("*.ui")
        for widget in ElementTree.parse(path).iter("widget")
    ]
    assert used <= set(names)
    assert len(names) == len(set(names))
