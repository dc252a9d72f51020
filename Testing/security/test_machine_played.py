"""A trial that a machine plays over the wire is recorded as such, and does no step of a study."""

from dataclasses import replace

import pytest

from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.study.database.study import Study
from rastrainer.study.protocol.steps import objections_to
from rastrainer.study.protocol.study_progress import StudyProgress
from rastrainer.study.protocol.study_protocol import StudyProtocol
from rastrainer.study.study_data import read_study_data
from rastrainer.trial.how_played import Allowance, HowPlayed, MovedBy, SeedSource
from rastrainer.trial.record import TrialRecord
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.report.report import report_html
from Testing.domain.trial.trial_records import gentle_score, make_record
from Testing.end_to_end.simulator_process import SimulatorProcess
from Testing.end_to_end.test_trial_over_openigtlink import SPEED, TASK, Player, play

BY_HAND = HowPlayed("gamepad", way_mm={MovedBy.STICKS.value: 900.0}, view_s={"desktop": 60})


@pytest.fixture(scope="module")
def machine_played(scenario, tmp_path_factory) -> TrialRecord:
    """The record of a trial that a client plays twice with the same seed, as it is delivered."""
    records = tmp_path_factory.mktemp("records")
    with (
        SimulatorProcess(records, "--no-views", "--speed", SPEED) as simulator,
        Player(simulator.port) as player,
    ):
        # An abort reveals the seed, too.
        trial = player.do("StartTask", task=TASK, trainee="anna", seed=5)
        player.do("Abort", trialId=trial["trialId"])
        play(player, scenario, mode="hmd")
        return record_from_json(TrialRecord, player.next_offer())


@pytest.fixture(scope="module")
def scenario():
    from rastrainer.scenario.scenario import load_scenario

    return load_scenario(asset_path("scenarios", "colin27"))


@pytest.fixture
def study(tmp_path):
    """A study whose only step is a trial in the headset."""
    protocol = StudyProtocol.read(asset_path("studies", "published-protocol.json"))
    step = {"modes": ("hmd",), "tasks": (TASK,), "repetitions": 1, "trial_run_min": 0.0}
    with Study.open(tmp_path / "study.db") as study:
        study.create_trainee("anna", consent=True)
        StudyProgress(study).set_protocol(replace(protocol, questionnaires=(), **step))
        StudyProgress(study).enroll("anna")
        yield study


def test_a_record_says_that_a_machine_played_the_trial(machine_played):
    played = machine_played.played
    assert played.started_by == "player"
    assert played.commanded_share == 1.0
    assert played.way_mm[MovedBy.COMMANDS.value] > 1000.0
    assert played.seed_source == SeedSource.CLIENT.value
    assert played.is_seed_repeated
    assert played.speed == float(SPEED)
    assert played.view_s == {}


def test_a_machines_trial_is_stored_but_counts_for_no_step_and_the_report_says_why(
    machine_played, study
):
    # As if it had been played after the enrollment by any clock.
    record = replace(machine_played, started_utc="2999-01-01T10:00:00Z")
    study.add_trial(record_to_json(record), score=gentle_score(110.0, 0.5))
    progress = StudyProgress(study)
    step = progress.count_played("anna").due()
    assert step.name == f"hmd/1/{TASK}"
    assert "a client's commands moved the arm" in "; ".join(objections_to(step, record))
    own = make_record(trainee="anna", mode="hmd", startedUtc="2999-01-01T11:00:00Z")
    played = {"played": {**vars_of(BY_HAND), "viewS": {"headset": 60}}}
    study.add_trial(own | played, score=gentle_score(110.0, 0.5))
    assert progress.count_played("anna").counted_trials == (own["trialId"],)
    page = report_html(read_study_data(study.database.path))
    assert "Trials that did not count, and why" in page
    assert "the pose of the head was chosen by a client" in page


def test_a_step_in_the_headset_needs_a_headset():
    assert BY_HAND.objections("desktop", ()) == ()
    assert BY_HAND.objections("hmd", ()) == ("the headset was worn 0 % of the time",)
    assert BY_HAND.objections("hmd", (Allowance.OTHER_VIEW.value,)) == ()
    worn = replace(BY_HAND, view_s={"headset": 60, "desktop": 1})
    assert worn.objections("hmd", ()) == ()
    assert worn.objections("desktop", ()) == ("it was played in a headset",)


def vars_of(played: HowPlayed) -> dict:
    return record_to_json(played, with_defaults=True)
