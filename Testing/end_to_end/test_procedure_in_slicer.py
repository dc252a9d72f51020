"""Slicer leads a procedure against a real simulator, is lost in each phase, and scores it."""

from __future__ import annotations

import threading
import time

import numpy as np
import pytest
from slicer.util import arrayFromVTKMatrix

from rastrainer.commands import CommandName
from rastrainer.protocol import DEFAULT_HOST, PROCEDURE_PHASES, Phase
from rastrainer.scenario.scenario import load_scenario
from rastrainer.slicer.scene.nodes import LINE, Role, nodesOf, nodesOfClass
from rastrainer.study.database.study import Study
from rastrainer_headless.headless_session import openSession, process
from rastrainer_headless.scene import HeadlessScene
from rastrainer_simulator.assets import asset_path
from Testing.end_to_end.simulator_process import SimulatorProcess
from Testing.end_to_end.test_trial_over_openigtlink import SPEED, Player, play

PROCEDURE = "biopsy"
FEED_MM_S, FEED_S = 10.0, 1.0
WITHIN_S = 300.0


class Leader:
    """The whole session of Slicer's module, whose timer the test is."""

    def __init__(self, folder, port: int):
        self.session = openSession(HeadlessScene(), folder, asset_path())
        self.session.isSeen = lambda _slices: True
        self.answers: list[str] = []
        self.session.procedure.answered.connect(self.answers.append)
        self.session.link.connectTo(DEFAULT_HOST, port)

        self.place = folder, port

    def lost(self) -> Leader:
        """Break off without notice, like a killed process, and return a new Leader."""
        self.session.link.connector.Stop()
        other = Leader(*self.place)
        other.until(lambda: other.session.link.seen.isOpen and other.status.name)
        return other

    @property
    def status(self):
        return self.session.procedure.status.procedure

    def until(self, condition) -> None:
        deadline = time.monotonic() + WITHIN_S
        while not condition():
            process(self.session)
            self.session.work.yieldTime()
            time.sleep(0.005)
            assert time.monotonic() < deadline, (self.status, self.answers)

    def until_in(self, phase: Phase) -> None:
        self.until(lambda: self.session.procedure.status.phase == phase.value)

    def is_aligned(self) -> bool:
        off = (self.status.entryDistanceMm, self.status.angleDeg)
        return None not in off and max(off) < 0.01

    def feed_to(self, depth_mm: float) -> None:
        while self.status.feedMm < depth_mm:
            before = self.status.feedMm
            arguments = {"velocityMmS": FEED_MM_S, "durationS": FEED_S}
            self.session.link.send(CommandName.FEED, arguments)
            self.until(lambda before=before: self.status.feedMm > before)

    def slices(self) -> dict:
        """The axes and origins of the slice views, (4, 4) float."""
        views = nodesOfClass(self.session._scene, "vtkMRMLSliceNode")
        return {view.GetName(): arrayFromVTKMatrix(view.GetSliceToRAS()) for view in views}


def found(leader: Leader, seen: dict) -> Leader:
    """Lose Slicer's side; note the phase before and what the next one finds, and return that."""
    other = leader.lost()
    seen["lost"].append(leader)
    seen["found"].append((leader.session.procedure.status, other.session.procedure.status))
    return other


@pytest.fixture(scope="module")
def led(tmp_path_factory):
    """What Slicer's side saw while it led a procedure with one line."""
    folder = tmp_path_factory.mktemp("led")
    scenario = load_scenario(asset_path("scenarios", "colin27"))
    seen: dict = {"scenario": scenario, "lost": [], "found": []}
    with SimulatorProcess(folder / "records", "--no-views", "--speed", SPEED) as simulator:
        leader = Leader(folder, simulator.port)
        leader.until(lambda: leader.session.link.seen.isOpen)
        with Player(simulator.port) as player:
            touching = threading.Thread(
                target=play, args=(player, scenario), kwargs={"procedure": PROCEDURE}, daemon=True
            )
            touching.start()
            leader.until(lambda: not touching.is_alive())
            leader.until(lambda: leader.status.registrationInUse)
            seen["axial"] = leader.slices()
            leader = found(leader, seen)
            leader.session.procedure.command(CommandName.ACCEPT_REGISTRATION)
            leader.until_in(Phase.ALIGNING)
            leader = found(leader, seen)
            leader.session.procedure.command(CommandName.ALIGN_GUIDE)
            leader.until(leader.is_aligned)
            leader.session.procedure.command(CommandName.LOCK_GUIDE)
            leader.until_in(Phase.DRILLING)
            once = {"velocityMmS": 2.0, "durationS": 0.5}
            leader.session.procedure.command(CommandName.FEED, once)
            leader.until(lambda: leader.status.feedMm > 0.9)
            leader.feed_to(55.0)
            seen["along"] = leader.slices()
            leader = found(leader, seen)
            leader.session.procedure.command(CommandName.START_INSERTION)
            leader.until_in(Phase.INSERTING)
            line = scenario.procedure(PROCEDURE).trajectories[0]
            leader.feed_to(30.0 + line.length_mm)
            leader = found(leader, seen)
            procedure, session = leader.session.procedure, leader.session
            procedure.command(CommandName.RELEASE_INSTRUMENT)
            leader.until(lambda: procedure.outcome is not None)
            seen["after"] = leader.slices()
        seen["outcome"], seen["true lines"] = procedure.outcome, procedure.lines
        seen["scene"] = session._scene
        seen["lines"] = {
            role: len(nodesOf(session._scene, LINE, role))
            for role in (Role.PLANNED_LINE, Role.REGISTERED_LINE, Role.TRUE_LINE)
        }
        seen["answers"] = leader.answers
        procedure.showOutcome(None)
        seen["cleared"] = len(nodesOf(session._scene, LINE, Role.PLANNED_LINE))
        with session.openStudy() as study:
            session.replay.show(study.history("anna")[0])
        seen["shown again"] = procedure.outcome
        seen["lines again"] = len(nodesOf(session._scene, LINE, Role.TRUE_LINE))
        for each in (*seen["lost"], leader):
            each.session.close()
    with Study.open_for_reading(folder / "study.db") as study:
        (seen["stored"],) = study.history("anna")
    return seen


def test_the_procedure_is_registered_guided_and_scored_by_slicer(led):
    outcome, record = led["outcome"], led["stored"].record
    assert [answer for answer in led["answers"] if answer] == []
    assert record.procedure.procedure == PROCEDURE
    (errors,) = outcome.analysis.trajectories
    assert errors.target_point_error.mm > 0.0
    assert errors.entry_point_error.by_hand_mm < 0.1
    assert errors.self_aligned
    assert outcome.score.version == "procedure-1"
    assert led["lines"] == dict.fromkeys(led["lines"], 1)


def test_a_slicer_lost_in_a_phase_finds_the_procedure_unchanged(led):
    phases = [before.phase for before, _after in led["found"]]
    assert phases == [phase.value for phase in PROCEDURE_PHASES]
    for before, after in led["found"]:
        assert (after.phase, after.procedure.name) == (before.phase, before.procedure.name)
        assert after.procedure.registrationInUse
        assert after.procedure.feedMm >= before.procedure.feedMm


def test_the_score_of_the_procedure_is_stored_beside_that_of_the_touches(led):
    stored = led["stored"]
    assert stored.procedure.score == led["outcome"].score
    assert stored.score is not None


def test_a_stored_trial_is_shown_again_with_its_lines(led):
    assert led["cleared"] == 0
    assert led["lines again"] == 1
    again, first = led["shown again"].analysis, led["outcome"].analysis
    assert again.target_point_error_rms_mm == pytest.approx(first.target_point_error_rms_mm)


def test_the_slices_follow_the_instrument_and_are_then_restored(led):
    (line,) = led["true lines"]
    shown = (line.shown[1] - line.shown[0]) / np.linalg.norm(line.shown[1] - line.shown[0])
    across = led["along"]["Red"][:3, 2]
    assert abs(across @ shown) > 0.9999
    for name in ("Green", "Yellow"):
        assert abs(led["along"][name][:3, 2] @ shown) < 0.01
    for name, matrix in led["axial"].items():
        assert np.array_equal(led["after"][name][:3, :3], matrix[:3, :3])
