"""Who may import whom: `panels → slicer → domain` and `rastrainer_simulator → domain`."""

from __future__ import annotations

import ast
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
DOMAIN = ROOT / "RASTrainer" / "Logic" / "rastrainer"
SIMULATOR = ROOT / "RASTrainerSimulatorServer" / "rastrainer_simulator"
SLICER_SIDE = {"slicer", "panels"}


def imported_modules(path: Path) -> set[str]:
    modules = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            modules |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path} imports relatively; the rule is absolute imports"
            modules |= {node.module} | {f"{node.module}.{alias.name}" for alias in node.names}
    return modules


def files(folder: Path, without: set[str] = frozenset()) -> list[Path]:
    found = sorted(folder.rglob("*.py"))
    return [path for path in found if path.relative_to(folder).parts[0] not in without]


def forbidden(path: Path, *prefixes: str) -> list[str]:
    return [
        module
        for module in imported_modules(path)
        if any(module == prefix or module.startswith(prefix + ".") for prefix in prefixes)
    ]


@pytest.mark.parametrize("path", files(DOMAIN, without=SLICER_SIDE), ids=lambda path: path.name)
def test_domain_imports_only_numpy_the_standard_library_and_itself(path):
    allowed = {*sys.stdlib_module_names, "numpy", "rastrainer", "fastcrc"}
    assert {module.partition(".")[0] for module in imported_modules(path)} <= allowed
    assert not forbidden(path, "rastrainer.slicer", "rastrainer.panels")


@pytest.mark.parametrize("path", files(SIMULATOR), ids=lambda path: path.name)
def test_simulator_never_imports_slicer(path):
    side = ("slicer", "qt", "ctk", "rastrainer.slicer", "rastrainer.panels")
    assert not forbidden(path, *side)


@pytest.mark.parametrize("path", files(DOMAIN / "slicer"), ids=lambda path: path.name)
def test_slicer_logic_imports_no_qt_and_never_the_simulator(path):
    assert not forbidden(path, "qt", "ctk", "rastrainer.panels", "rastrainer_simulator")


@pytest.mark.parametrize("path", files(DOMAIN / "panels"), ids=lambda path: path.name)
def test_panels_never_import_the_simulator(path):
    assert not forbidden(path, "rastrainer_simulator")


def test_only_the_checksum_may_look_for_a_package_that_slicer_lacks():
    users = [path.name for path in files(DOMAIN) if forbidden(path, "fastcrc")]
    assert users in ([], ["checksum.py"])
