"""The module works with a study in PostgreSQL that is chosen by its address in the panel."""

from __future__ import annotations

import pytest

from rastrainer.study.database import postgres_connecting, postgres_database
from rastrainer.study.database.study import Study
from Testing.postgres_server import PostgresServer


@pytest.fixture
def server(monkeypatch):
    """A busy machine may take longer to connect than a window waits."""
    monkeypatch.setattr(postgres_database, "INTERACTIVE_PATIENCE_S", 60.0)
    monkeypatch.setattr(postgres_connecting, "INTERACTIVE_SILENCE_S", 60)
    with PostgresServer() as server:
        yield server


def names(host):
    combo = host.find("traineeComboBox")
    return [combo.itemText(row) for row in range(1, combo.count)]


@pytest.mark.soak
def test_a_study_at_an_address_is_used_remembered_and_left_again(start_slicer, server):
    place = server.new_study()
    with Study.open(place) as study:
        study.create_trainee("Blue")
    host = start_slicer("trainees")
    host.press("createTraineeButton")
    assert names(host) == ["T001"]
    host.type("studyAddressLineEdit", str(place))
    assert names(host) == ["Blue"]
    assert not host.find("studyPathLineEdit").enabled
    host.press("createTraineeButton")
    with Study.open(place) as another_seat:
        another_seat.create_trainee("Green")
    host.wait_until(lambda: names(host) == ["Blue", "Green", "T002"], "the list shows it")
    host = start_slicer("trainees")
    assert host.text("studyAddressLineEdit") == str(place)
    assert names(host) == ["Blue", "Green", "T002"]
    host.type("studyAddressLineEdit", "")
    assert names(host) == ["T001"]
    assert host.find("studyPathLineEdit").enabled
    with Study.open(place) as study:
        assert len(study.trainees()) == 3
