"""The table of a class whose study is in PostgreSQL: as from a file, and through an outage."""

from __future__ import annotations

import pytest

from rastrainer.study.database.study import Study
from rastrainer_simulator.board.class_table import ClassReader
from Testing.postgres_server import PostgresServer
from Testing.simulator.board.class_study import play_class
from Testing.simulator.board.test_class_table import NAMES, tables, until

pytestmark = pytest.mark.soak


@pytest.fixture
def server():
    """A server that the test may stop."""
    with PostgresServer() as server:
        yield server


def test_the_table_matches_that_of_a_file_follows_changes_and_outlives_the_server(
    server, open_board, tmp_path
):
    place, path = server.new_study(), tmp_path / "study.db"
    for each in (place, path):
        play_class(each, NAMES, 12)
    reader = ClassReader(path)
    expected = tables(reader)
    reader.close()
    board = open_board(place)
    assert until(board, lambda found: found["curricula"])["curricula"] == expected
    with Study.open(place) as study:
        study.create_trainee("T099")
    seen = until(board, lambda found: len(found["curricula"][0]["trainees"]) == 5)
    server.kill()
    gone = until(board, lambda found: found["problem"])
    assert gone["curricula"] == seen["curricula"]
    assert "cannot be reached" in gone["problem"]
    server.start()
    assert until(board, lambda found: not found["problem"])["curricula"] == seen["curricula"]
