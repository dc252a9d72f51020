"""The parts of the tests that take long: each test is in one, and each is run by its name."""

import sys
from types import SimpleNamespace

import pytest

from Testing import soak

MARKED = [
    path.relative_to(soak.ROOT).as_posix()
    for path in (soak.ROOT / "Testing").rglob("test_*.py")
    if "mark.soak" in path.read_text(encoding="utf-8")
]


def test_each_part_has_tests_and_each_test_is_in_a_part():
    places = [place for part in soak.PARTS for place in part.places]
    assert all((soak.ROOT / "Testing" / place).exists() for place in places)
    assert len(set(places)) == len(places)
    parts = [set(soak.files_of(part)) & set(MARKED) for part in soak.PARTS]
    assert all(parts)
    assert sorted(file for files in parts for file in files) == sorted(MARKED)


@pytest.mark.parametrize("word", ["12", "long run"])
def test_a_part_is_run_by_its_number_or_name(monkeypatch, word):
    commands = []

    def run(command, **_others):
        commands.append(command)
        return SimpleNamespace(returncode=1)

    monkeypatch.setattr(soak.subprocess, "run", run)
    assert soak.main([word]) == 1
    (command,) = commands
    assert command[:2] == [sys.executable, "-m"]
    assert command[-2:] == [
        "Testing/end_to_end/test_crowd.py",
        "Testing/end_to_end/test_long_run.py",
    ]


def test_an_unknown_part_is_refused(capsys):
    assert soak.main(["99"]) == 2
    assert "PART=list" in capsys.readouterr().err
