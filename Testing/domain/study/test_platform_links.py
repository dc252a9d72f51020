"""Who is which user of a learning platform: kept beside the study, and forgotten completely."""

from __future__ import annotations

import dataclasses

import pytest

from rastrainer.errors import InputError
from rastrainer.study.database.study import Study
from rastrainer.study.platform_links import LinkedAssignment, PlatformLinks
from rastrainer_simulator.cli.main import main

ISSUER = "https://courses.example.org"
TASK = LinkedAssignment(
    ISSUER, "tool-1", "u1", f"{ISSUER}/1", "task-1", "", "fiducials", "best", "2026-01-01T10:00:00Z"
)


@pytest.fixture
def links(tmp_path):
    return PlatformLinks(tmp_path / "study.db")


def test_changed_settings_of_a_link_keep_what_was_sent(links):
    links.link(ISSUER, "u1", "T001")
    links.put(TASK)
    links.note_sent(TASK, 70.5, "2026-01-01T11:00:00Z")
    changed = dataclasses.replace(TASK, task="task-2", rule="latest")
    links.put(changed)
    sent = dataclasses.replace(changed, sent_score=70.5, sent_utc="2026-01-01T11:00:00Z")
    assert links.assignments() == [("T001", sent)]


def test_forgetting_a_trainee_leaves_nothing_of_their_link(links):
    links.link(ISSUER, "u1", "T001")
    links.link(ISSUER, "u2", "T002")
    links.put(TASK)
    links.forget("T001")
    assert links.assignments() == []
    assert links.pseudonym(ISSUER, "u1") is None
    assert links.users("T002") == [{"issuer": ISSUER, "subject": "u2"}]


def test_no_file_is_written_if_nobody_is_linked(links):
    links.forget("T001")
    assert links.users("T001") == []
    assert not links.path.exists()


def test_a_copy_of_a_study_has_the_same_users_and_grades(links, tmp_path, capsys):
    with Study.open(tmp_path / "study.db") as study:
        study.create_trainee()
    links.link(ISSUER, "u1", "T001")
    links.put(TASK)
    links.note_sent(TASK, 70.5, "2026-01-01T11:00:00Z")
    copied = PlatformLinks(tmp_path / "copy.db")
    copied.link(ISSUER, "u2", "T001")
    assert main(["copy-study", str(tmp_path / "study.db"), str(tmp_path / "copy.db")]) == 0
    assert "1 user of learning platforms" in capsys.readouterr().out
    assert copied.assignments() == links.assignments()
    assert copied.users("T001") == links.users("T001")
    assert main(["copy-study", str(tmp_path / "study.db"), str(tmp_path / "copy.db")]) == 2
    assert copied.assignments() == links.assignments()


def test_a_damaged_file_is_named_and_left_as_it_is(links):
    links.path.write_bytes(b"no database" * 100)
    with pytest.raises(InputError, match=r"study\.db\.lti\.db cannot be used: file is not a"):
        links.pseudonyms()
    assert links.path.read_bytes() == b"no database" * 100
