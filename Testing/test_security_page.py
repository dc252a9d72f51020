"""SECURITY.md names files of tests that exist, and every file of attacks."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "SECURITY.md").read_text(encoding="utf-8")
NAMED = sorted(set(re.findall(r"`(Testing/[\w/]+\.py)`", PAGE)))


def test_each_row_of_the_tables_names_a_file_of_tests():
    for file in NAMED:
        assert re.search(r"^def test_", (ROOT / file).read_text(encoding="utf-8"), re.MULTILINE)
    rows = [line for line in PAGE.splitlines() if line.startswith("| ") and "---" not in line]
    guarded = [row for row in rows if not row.endswith("| tests |")]
    assert len(guarded) > 20
    assert all("/test_" in row.split(" | ")[-1] for row in guarded)


def test_every_file_of_attacks_is_named_on_the_page():
    files = {f"Testing/security/{path.name}" for path in (ROOT / "Testing/security").glob("test_*")}
    assert files <= set(NAMED)
