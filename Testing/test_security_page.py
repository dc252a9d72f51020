"""SECURITY.md names tests that exist, and lists every test of attacks."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "SECURITY.md").read_text(encoding="utf-8")
NAMED = re.findall(r"`(Testing/[\w/]+\.py)::(test_\w+)`", PAGE)


def names_in(path: Path) -> set[str]:
    tree = ast.parse(path.read_text(encoding="utf-8"))
    found = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    return {node.name for node in found if node.name.startswith("test_")}


@pytest.mark.parametrize(("file", "name"), NAMED, ids=[name for _, name in NAMED])
def test_each_refused_attack_has_the_test_that_is_named(file, name):
    assert name in names_in(ROOT / file)


def test_each_row_of_the_tables_names_a_test():
    rows = [line for line in PAGE.splitlines() if line.startswith("| ") and "---" not in line]
    attacks = [row for row in rows if not row.endswith("| test |")]
    assert len(attacks) > 40
    assert all("::test_" in row for row in attacks)


def test_every_attack_test_is_listed_on_the_page():
    named = set(NAMED)
    for path in sorted((ROOT / "Testing" / "security").glob("test_*.py")):
        file = path.relative_to(ROOT).as_posix()
        missing = {name for name in names_in(path) if (file, name) not in named}
        assert missing <= OF_THE_TESTS_THEMSELVES, file


OF_THE_TESTS_THEMSELVES = {
    "test_the_same_seed_gives_the_same_attack_which_includes_every_valid_message",
    "test_every_acceptable_command_is_among_those_that_are_mutated",
    "test_the_wire_check_of_these_tests_detects_what_would_harm_slicer",
    "test_a_prepared_file_beside_a_robot_is_trusted_only_if_it_is_ours",
}
