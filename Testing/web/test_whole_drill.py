"""A drill of twenty cases, played whole by each device, with Slicer's side connected or without."""

from __future__ import annotations

from contextlib import ExitStack

import pytest

from rastrainer.decision.drill_record import CASES, DrillRecord
from rastrainer.journal.folder import DRILL_SUFFIX
from rastrainer.journal.journal_file import Integrity, read_journal
from rastrainer.json_records import record_from_json
from rastrainer.study.database.study import Study
from Testing.end_to_end.lab import Place
from Testing.end_to_end.study_side import STUDY, StudySide
from Testing.end_to_end.test_drill_delivery import TIMEOUT_S, Scorer
from Testing.end_to_end.window_process import wait_until
from Testing.web.drill_player import PlayedCase, play_drill
from Testing.web.trainees_on_page import DEVICES, Device, ListeningTrainee, at_page


def check_record(played: list[PlayedCase], record: DrillRecord) -> None:
    """Check that the record has the played cases."""
    cases = [
        PlayedCase(
            float(f"{case.residual_mm:.2f}"),
            float(f"{case.true_error_mm:.1f}"),
            "".join(case.checks),
            case.decision,
            case.confidence,
            None if case.suspected is None else case.suspected.value,
        )
        for case in record.cases
    ]
    assert played == cases
    assert all(case.has_read_images for case in record.cases)
    assert len({case.seed for case in record.cases}) == CASES


def delivered_to_slicer(place: Place, study: Study) -> DrillRecord:
    """Wait until Slicer's side has stored the drill and acknowledged it; nobody gets it again."""

    def stored() -> list[DrillRecord]:
        return [drill for name in TRAINEES for drill in study.drills(name)]

    wait_until(stored, "the drill in the study", TIMEOUT_S)
    (drill,) = stored()

    def is_acknowledged(scorer: Scorer) -> bool:
        trial = {"trialId": drill.trial_id}
        return scorer.send_command("GetTrial", trial, TIMEOUT_S).data["acknowledged"]

    with Scorer(place.simulator.port) as scorer:
        wait_until(lambda: is_acknowledged(scorer), "the acknowledgement", TIMEOUT_S)
    with Scorer(place.simulator.port) as another:
        assert is_acknowledged(another)
        assert another.offers == []
    return drill


def delivered_later(place: Place) -> DrillRecord:
    """Fetch the drill if no other client does."""
    with Scorer(place.simulator.port) as scorer:
        record = record_from_json(DrillRecord, scorer.offered()[1])
        trial = {"trialId": record.trial_id}
        assert scorer.send_command("AcknowledgeTrial", trial, TIMEOUT_S).ok
    return record


TRAINEES = "P7", "A"
"""IDs: typed, and chosen by letters."""
BY_EAR = Device(ListeningTrainee, "keyboard")
WITH_SLICER = "keys", "a tracked hand", "the mouse", "by ear"


@pytest.mark.soak
@pytest.mark.parametrize("name", [*DEVICES, "by ear"])
def test_a_drill_is_played_whole_recorded_as_shown_and_delivered_once(name, browser, tmp_path):
    device = DEVICES.get(name, BY_EAR)
    with (
        at_page(
            device, browser, tmp_path, "--speed", device.speed, speech=device is BY_EAR
        ) as trainee,
        Study.open(tmp_path / STUDY) as study,
        ExitStack() as stack,
    ):
        place = trainee.place
        for trainee_id in TRAINEES:
            study.create_trainee(trainee_id)
        if name in WITH_SLICER:
            stack.enter_context(StudySide(tmp_path, place.simulator.port))
        played = play_drill(trainee)
        is_stored = name in WITH_SLICER
        record = delivered_to_slicer(place, study) if is_stored else delivered_later(place)
        check_record(played, record)
        (path,) = place.records.glob(f"*{DRILL_SUFFIX}")
        assert place.simulator.stop()[0] == 0
    journal = read_journal(path)
    assert journal.integrity is Integrity.INTACT
    assert len(journal.of_kind("acknowledged")) == 1
