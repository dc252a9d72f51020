"""Recordings are private to their user; files shared on purpose stay shared."""

import logging
import os
import stat
import uuid

import pytest

from rastrainer.files.writing import write_private_json
from rastrainer.study.database.study import Study
from rastrainer_simulator.flow.session.preferences import Preferences, write_preferences
from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS, write_bindings
from rastrainer_simulator.ops.log_files import keep_logs
from rastrainer_simulator.record.journal_writer import Journal, RecordsFolder

pytestmark = pytest.mark.skipif(os.name == "nt", reason="on Windows the profile protects")
ENTRY = {"type": "header", "trainee": "T-001"}


@pytest.fixture(autouse=True)
def generous():
    """A umask that lets others read and the group write."""
    before = os.umask(0o002)
    yield
    os.umask(before)


def mode(path):
    return stat.S_IMODE(path.stat().st_mode)


def use(home):
    """Create all private files in the user's folders."""
    Study.open(home / "RASTrainer" / "study.db", make_folder=True).close()
    records = RecordsFolder(home / "RASTrainer" / "trials")
    journal = Journal(home / "RASTrainer" / "trials" / f"{uuid.uuid4()}.journal")
    journal.write([ENTRY], sync=True)
    journal.close()
    records.close()
    write_preferences(home / "rastrainer" / "preferences.json", Preferences())
    write_bindings(home / "rastrainer" / "bindings.json", DEFAULT_BINDINGS)
    with keep_logs(home / "rastrainer" / "logs", "simulator"):
        logging.getLogger("rastrainer").warning("something")


def all_below(folder):
    paths = sorted(folder.rglob("*"))
    assert len([path for path in paths if path.is_file()]) >= 7
    return paths


def test_recordings_are_readable_by_their_user_only(tmp_path):
    use(tmp_path / "home")
    for path in all_below(tmp_path / "home"):
        assert mode(path) == (0o700 if path.is_dir() else 0o600), path


def test_existing_recordings_become_private_when_opened(tmp_path):
    use(tmp_path)
    (tmp_path / "RASTrainer" / "study.db-journal").write_bytes(b"")
    for path in all_below(tmp_path):
        path.chmod(0o775 if path.is_dir() else 0o664)
    use(tmp_path)
    for path in all_below(tmp_path):
        assert mode(path) & 0o077 == 0, path


def test_a_folder_shared_with_a_group_stays_shared(tmp_path):
    (tmp_path / "lab").mkdir()
    (tmp_path / "lab").chmod(0o2770)
    study = tmp_path / "lab" / "study.db"
    Study.open(study, make_folder=True).close()
    study.chmod(0o660)
    Study.open(study, make_folder=True).close()
    assert mode(study) == 0o660
    assert mode(tmp_path / "lab") == 0o2770
    path = tmp_path / "lab" / "seats.json"
    write_private_json(path, {})
    path.chmod(0o660)
    write_private_json(path, {"seats": []})
    assert mode(path) == 0o660
