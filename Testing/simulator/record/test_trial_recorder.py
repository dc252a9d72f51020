"""Everything is loaded before the first trial begins; a tick has no time to load anything."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import replace

from rastrainer.commands import CommandName, check_arguments
from rastrainer.journal.entries import DisplayReport, GhostReport, GuidanceReport, ProximityChange
from rastrainer.journal.recording import Recording
from rastrainer.motion.trial_motion import trial_motion
from rastrainer.protocol import Proximity
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.record.trial_context import display_summary
from rastrainer_simulator.record.trial_entries import TrialEntries
from rastrainer_simulator.state import Event, OperatorCommand, OperatorInput

PLAY_THE_FIRST_TRIAL = """
import json, sys, tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from rastrainer_simulator.virtual.hand import Skill
from rastrainer_simulator.record.trial_archive import TrialArchive
from rastrainer_simulator.record.trial_recorder import TrialRecorder
from rastrainer_simulator.core.setup import load_setup
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.virtual.play import play_virtual_trial

BRISK = Skill(speed_mm_s=300.0, gain_per_s=6.0, reaction_s=0.1, dwell_s=0.04, slip_at=3)
with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(1) as writer:
    simulation = Simulation(load_setup(), 1)
    recorder = TrialRecorder(Path(folder), TrialArchive(Path(folder)), writer, 0.05)
    before = set(sys.modules)
    play_virtual_trial(simulation, "task-1", 1, BRISK, 0.05, recorder.record)
    writer.submit(int).result()
    print(json.dumps(sorted(set(sys.modules) - before)))
"""


def test_no_module_is_loaded_while_the_first_trial_is_played_and_recorded():
    played = subprocess.run(
        [sys.executable, "-c", PLAY_THE_FIRST_TRIAL], capture_output=True, text=True, check=True
    )
    assert json.loads(played.stdout) == []


DT = 0.004
CONTACT = ProximityChange(from_=Proximity.PROXIMITY, to=Proximity.CONTACT, clearance_mm=0.0)


def test_a_contact_in_the_register_tick_counts_in_the_record_as_in_the_journal(anywhere):
    simulation = Simulation(anywhere, 3)

    def step(name, **arguments):
        command = OperatorCommand(name, check_arguments(name, arguments))
        given = OperatorInput(commands=(command,))
        before = simulation.state
        return before, given, simulation.step(DT, given)

    before, given, started = step(CommandName.START_TASK, task="task-1", trainee="P01")
    entries = TrialEntries.started(simulation, before, started, DT)
    entries.add(simulation, given, started)
    for _ in range(15):
        _, given, touched = step(CommandName.CAPTURE)
        entries.add(simulation, given, touched)
    _, given, done = step(CommandName.REGISTER)
    contact = Event(done.state.sim_time, CONTACT)
    record = entries.add(
        simulation, given, replace(done, events=(*done.events, contact))
    ).measured()
    assert record.motion["contacts"] == 1
    assert record.motion == trial_motion(Recording.of(entries.taken()).trajectory())


def test_the_record_names_the_last_view_all_frames_and_the_aids():
    guidance = GuidanceReport("arrow")
    assert display_summary([]) == {}
    assert display_summary([guidance]) == {"guidance": "arrow"}
    views = (
        DisplayReport("page", "Chrome/120", 60.0, 55, 5),
        DisplayReport("headset", "Quest 3", 90.0, 88, 2),
    )
    assert display_summary([guidance, GhostReport("expert"), *views]) == {
        "kind": "headset",
        "device": "Quest 3",
        "guidance": "arrow",
        "ghost": "expert",
        "refreshHz": 90.0,
        "shownFrames": 143,
        "droppedFrames": 7,
    }
