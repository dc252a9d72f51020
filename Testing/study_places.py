"""Where the tests keep a study: in SQLite, and in the soak test in PostgreSQL, too."""

from __future__ import annotations

from pathlib import Path

import pytest

from rastrainer.study.database.database import PostgresAddress
from rastrainer.study.database.study import Study
from Testing.postgres_server import PostgresServer


@pytest.fixture(scope="session")
def postgres_server():
    """A server for all tests that need only its databases."""
    with PostgresServer() as server:
        yield server


@pytest.fixture(params=["sqlite", pytest.param("postgresql", marks=pytest.mark.soak)])
def study_place(request, tmp_path) -> Path | PostgresAddress:
    """Where a test begins its study."""
    if request.param == "sqlite":
        return tmp_path / "study.db"
    return request.getfixturevalue("postgres_server").new_study()


@pytest.fixture
def study(study_place):
    """An open study without trainees."""
    with Study.open(study_place) as study:
        yield study
