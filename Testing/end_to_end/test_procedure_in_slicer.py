"""Slicer leads a procedure against a real simulator, is lost in each phase, and scores it."""

from __future__ import annotations

import contextlib
import threading
import time

import numpy as np
import pytest
from slicer.util import arrayFromVTKMatrix

from rastrainer.commands import CommandName
from rastrainer.protocol import DEFAULT_HOST, Phase
from rastrainer.scenario.scenario import load_scenario
from rastrainer.slicer.scene.nodes import NodeKind, Role, nodesOfClass
from rastrainer_headless.main import openSession, process
from rastrainer_headless.scene import HeadlessScene
from rastrainer_simulator.assets import asset_path
from Testing.end_to_end.simulator_process import SimulatorProcess
from Testing.end_to_end.test_trial_over_openigtlink import SPEED, Player, play

PROCEDURE = "biopsy"
WITHIN_S = 300.0


class Leader:
    """The whole session of Slicer's module, whose timer the test is."""

    def __init__(self, folder, port: int, sessions: contextlib.ExitStack):
        self.place = folder, port, sessions
        self.session = openSession(HeadlessScene(), folder, asset_path())
        sessions.callback(self.session.close)
        self.session.isSeen = lambda _slices: True
        self.answers: list[str] = []
        self.session.procedure.answered.connect(self.answers.append)
        self.session.link.connectTo(DEFAULT_HOST, port)
        self.until(lambda: self.session.link.seen.isOpen)

    def lost(self) -> Leader:
        """Break off without notice, like a killed process; return the next, who finds the same."""
        before = self.session.procedure.status
        self.session.link.connector.Stop()
        other = Leader(*self.place)
        other.until(lambda: other.status.name)
        after = other.session.procedure.status
        assert (after.phase, after.procedure.name) == (before.phase, PROCEDURE)
        assert after.procedure.registrationInUse
        assert after.procedure.feedMm >= before.procedure.feedMm
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

    def do(self, command: str, following: Phase) -> None:
        self.session.procedure.command(command)
        self.until(lambda: self.session.procedure.status.phase == following.value)

    def is_aligned(self) -> bool:
        off = (self.status.entryDistanceMm, self.status.angleDeg)
        return None not in off and max(off) < 0.01

    def feed_to(self, depth_mm: float) -> None:
        while self.status.feedMm < depth_mm:
            before = self.status.feedMm
            self.session.link.send(CommandName.FEED, {"velocityMmS": 10.0, "durationS": 1.0})
            self.until(lambda before=before: self.status.feedMm > before)

    def slices(self) -> dict:
        """The axes and origins of the slice views, (4, 4) float."""
        views = nodesOfClass(self.session._scene, "vtkMRMLSliceNode")
        return {view.GetName(): arrayFromVTKMatrix(view.GetSliceToRAS()) for view in views}

    def lines(self, role: NodeKind) -> int:
        return len(role.all(self.session._scene))


def test_slicer_leads_a_procedure_though_it_is_lost_in_each_phase_and_scores_it(tmp_path):
    scenario = load_scenario(asset_path("scenarios", "colin27"))
    (planned,) = scenario.procedure(PROCEDURE).trajectories
    with (
        SimulatorProcess(tmp_path / "records", "--no-views", "--speed", SPEED) as simulator,
        contextlib.ExitStack() as sessions,
        Player(simulator.port) as player,
    ):
        leader = Leader(tmp_path, simulator.port, sessions)
        touching = threading.Thread(
            target=play, args=(player, scenario), kwargs={"procedure": PROCEDURE}, daemon=True
        )
        touching.start()
        leader.until(lambda: not touching.is_alive())
        leader.until(lambda: leader.status.registrationInUse)
        axial = leader.slices()
        leader = leader.lost()
        leader.do(CommandName.ACCEPT_REGISTRATION, Phase.ALIGNING)
        leader = leader.lost()
        leader.session.procedure.command(CommandName.ALIGN_GUIDE)
        leader.until(leader.is_aligned)
        leader.do(CommandName.LOCK_GUIDE, Phase.DRILLING)
        leader.feed_to(55.0)
        along = leader.slices()
        leader = leader.lost()
        leader.do(CommandName.START_INSERTION, Phase.INSERTING)
        leader.feed_to(30.0 + planned.length_mm)
        leader = leader.lost()
        session, procedure = leader.session, leader.session.procedure
        procedure.command(CommandName.RELEASE_INSTRUMENT)
        leader.until(lambda: procedure.outcome is not None)
        outcome, (line,), after = procedure.outcome, procedure.lines, leader.slices()
        assert [answer for answer in leader.answers if answer] == []
        for role in (Role.PLANNED_LINE, Role.REGISTERED_LINE, Role.TRUE_LINE):
            assert leader.lines(role) == 1
        procedure.showOutcome(None)
        assert leader.lines(Role.PLANNED_LINE) == 0
        with session.openStudy() as study:
            (stored,) = study.history("anna")
        session.replay.show(stored)
        assert leader.lines(Role.TRUE_LINE) == 1
        again = procedure.outcome.analysis
    (errors,) = outcome.analysis.trajectories
    assert errors.target_point_error.mm > 0.0
    assert errors.entry_point_error.by_hand_mm < 0.1
    assert errors.self_aligned
    assert again.target_point_error_rms_mm == pytest.approx(errors.target_point_error.mm)
    assert stored.record.procedure.procedure == PROCEDURE
    assert stored.procedure.score == outcome.score
    assert stored.score is not None
    # The slices followed the instrument, and were then restored.
    shown = (line.shown[1] - line.shown[0]) / np.linalg.norm(line.shown[1] - line.shown[0])
    assert abs(along["Red"][:3, 2] @ shown) > 0.9999
    for name in ("Green", "Yellow"):
        assert abs(along[name][:3, 2] @ shown) < 0.01
    for name, matrix in axial.items():
        assert np.array_equal(after[name][:3, :3], matrix[:3, :3])
