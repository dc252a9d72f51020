"""A drill at the real simulator is stored by Slicer's side, whatever ends, and done as a step."""

from __future__ import annotations

import time
from contextlib import ExitStack

from rastrainer.decision.drill_record import CASES
from rastrainer.study.database.study import Study
from rastrainer.study.protocol.study_progress import StudyProgress
from rastrainer.study.protocol.study_protocol import StudyProtocol
from rastrainer_simulator.assets import asset_path
from Testing.end_to_end.study_side import RECORDS, STUDY, StudySide
from Testing.end_to_end.test_drill_delivery import Drilling, Scorer

TIMEOUT_S = 120.0


def wait_for_drills(study):
    end = time.monotonic() + TIMEOUT_S
    while not (drills := study.drills("P01")):
        assert time.monotonic() < end, "no drill was stored"
        time.sleep(0.05)
    return drills


def test_a_drill_that_ends_without_slicer_is_stored_once_and_its_step_is_done(tmp_path):
    plan = StudyProtocol.read(asset_path("studies", "published-protocol.json")).to_json()
    plan |= {"modes": ["desktop"], "questionnaires": [], "drills": ["before-all", "after-all"]}
    with Study.open(tmp_path / STUDY) as study:
        study.create_trainee("P01")
        progress = StudyProgress(study)
        progress.set_protocol(StudyProtocol.from_json(plan))
        progress.enroll("P01")
        with Drilling(tmp_path / RECORDS) as simulator:
            with StudySide(tmp_path, simulator.port):
                simulator.do("decide")
            last = simulator.do(*["next", "decide"] * (CASES - 1), "see")
            with StudySide(tmp_path, simulator.port), ExitStack() as stack:
                (drill,) = wait_for_drills(study)
                assert (drill.trial_id, len(drill.cases)) == (last["trialId"], CASES)
                scorer = stack.enter_context(Scorer(simulator.port))
                trial = {"trialId": drill.trial_id}
                end = time.monotonic() + TIMEOUT_S
                while not scorer.send_command("GetTrial", trial, 60.0).data["acknowledged"]:
                    assert time.monotonic() < end, "the drill was not acknowledged"
                    time.sleep(0.1)
        assert study.drills("P01") == (drill,)
        assert progress.count_played("P01").counted_trials == (drill.trial_id,)
        assert progress.progress("P01").next_step.name == "desktop/trial-run"
        study.delete_trainee("P01")
        assert study.is_deleted(drill.trial_id)
