"""The simulator that records in a folder is read from the lock while it is held."""

import os

import pytest

from rastrainer.journal.folder import LOCK_NAME, FolderHolder, lock, read_holder, write_holder

HOLDER = FolderHolder(
    4711, "2026-01-02T03:04:05.000+00:00", "Slicer", "127.0.0.1", 18944, "http://x"
)


@pytest.fixture
def held(tmp_path):
    """The descriptor of a held lock."""
    descriptor = os.open(tmp_path / LOCK_NAME, os.O_RDWR | os.O_CREAT)
    lock(descriptor)
    yield descriptor
    os.close(descriptor)


def test_the_holder_of_a_folder_is_read_from_the_lock(held, tmp_path):
    write_holder(held, HOLDER)
    assert read_holder(tmp_path) == HOLDER
    write_holder(held, FolderHolder(4711))
    assert read_holder(tmp_path) == FolderHolder(4711)


def test_a_lock_left_by_a_dead_process_names_nobody(tmp_path):
    descriptor = os.open(tmp_path / LOCK_NAME, os.O_RDWR | os.O_CREAT)
    lock(descriptor)
    write_holder(descriptor, HOLDER)
    os.close(descriptor)
    assert read_holder(tmp_path) is None
    assert read_holder(tmp_path) is None
    assert read_holder(tmp_path / "nowhere") is None


@pytest.mark.parametrize("said", [b"", b"1234", b'{"pid": "x"}', b"[]", b"\xff", b'{"pid": 12'])
def test_a_held_folder_with_an_unreadable_lock_has_an_unknown_holder(held, tmp_path, said):
    os.write(held, said)
    assert read_holder(tmp_path) == FolderHolder()
