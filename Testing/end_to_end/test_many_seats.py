"""One study in PostgreSQL: twelve trainees move between three seats, and everything is killed.

Each seat is a simulator and Slicer's side, in two processes. Simulators die while a trainee plays,
at a message or with a command on its way; Slicer's sides and the database at any time.
"""

from __future__ import annotations

import contextlib
import json
import random
import signal
import time
from concurrent.futures import ThreadPoolExecutor

import pytest

from rastrainer.errors import InputError
from rastrainer.journal.journal_file import Integrity, read_journal
from rastrainer.scenario.scenario import load_scenario
from rastrainer.study.database.study import Study
from rastrainer.study.protocol.questionnaires import SUS
from rastrainer.study.protocol.study_progress import StudyProgress
from rastrainer.study.protocol.study_protocol import StudyProtocol
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.record.trial_archive import SUFFIX, find_unacknowledged
from Testing.domain.study.played_study import STUDIES
from Testing.domain.study.study_content import rows_of, written_files
from Testing.end_to_end.finished_trials import COLIN
from Testing.end_to_end.fork_server import SIMULATOR, STUDY_SIDE, ForkServer
from Testing.end_to_end.simulator_process import READY
from Testing.end_to_end.study_side import RECORDS
from Testing.end_to_end.surviving_player import Killing, SurvivingPlayer
from Testing.free_port import free_port
from Testing.postgres_server import PostgresServer, opened_when_available

pytestmark = pytest.mark.soak
TRAINEES = [f"P{number:02d}" for number in range(1, 13)]
TASKS = ("task-1", "task-2")
SEATS = 3
KILLED_SIMULATORS, KILLED_SLICERS, KILLED_DATABASES = 14, 10, 28
"""Per seat, per seat, and in total."""
KILLS = SEATS * (KILLED_SIMULATORS + KILLED_SLICERS) + KILLED_DATABASES
PROTOCOL = {
    "modes": ["desktop"],
    "modeOrder": "fixed",
    "tasks": list(TASKS),
    "allows": ["commands", "chosen seed", "repeated seed", "other speed", "pauses", "other view"],
    "taskOrder": "fixed",
    "repetitions": 1,
    "trialRunMin": 0,
    "breakBetweenModesMin": 0,
    "breakBetweenTasksMin": 0,
    "questionnaires": [{"name": "sus", "when": "after-mode", "modes": []}],
}
PATIENCE_S = 600.0
"""After this, nothing changes any more."""


class Seat:
    """A simulator and Slicer's side, which come and go."""

    def __init__(self, folder, place, nurseries, seed):
        folder.mkdir()
        self.folder, self.port = folder, free_port()
        self._place = str(place)
        self._simulators, self._slicers = nurseries
        self.rng = random.Random(seed)
        self.player = SurvivingPlayer(load_scenario(COLIN), random.Random(seed + 100))
        self.killed_simulators = self.killed_slicers = 0
        self.start_simulator()
        self.start_slicer()

    def start_simulator(self):
        words = ("--no-views", "--speed", "10", "--port", str(self.port))
        folders = ("--records", str(self.records), "--config", str(self.folder / "config"))
        simulator = self._simulators.fork("simulator", *folders, *words)
        ready = simulator.next_line()
        assert ready.startswith(READY), ready
        simulator.drain_output()
        self.end_simulator = simulator.end

    def start_slicer(self):
        slicer = self._slicers.fork(str(self.folder), str(self.port), self._place)
        slicer.drain_output()
        self.end_slicer = slicer.end

    @property
    def records(self):
        return self.folder / RECORDS

    def play(self, trainee, task, kills):
        """Play a trial to its end, through up to `kills` deaths of the simulator."""
        self.player.trainee, self.player.task = trainee, task
        while kills:
            killing = Killing(self.rng, self.kill_simulator)
            is_done = self.player.play(self.port, killing, 1)
            if is_done and not killing.is_done:
                return
            kills -= 1
            self.start_simulator()
            if is_done:
                return
        assert self.player.play(self.port, None, 1)

    def kill_simulator(self):
        self.killed_simulators += 1
        self.end_simulator(signal.SIGKILL)

    def kill_slicer(self):
        self.killed_slicers += 1
        self.end_slicer(signal.SIGKILL)
        self.start_slicer()


def patiently(ask):
    """Return the first true answer, even while the database is away; give up at last."""
    give_up = time.monotonic() + PATIENCE_S
    while True:
        with contextlib.suppress(InputError):
            if found := ask():
                return found
        assert time.monotonic() < give_up
        time.sleep(0.2)


class Lab:
    """The study, its server, and the seats."""

    def __init__(self, folder, server, nurseries):
        self.server, self.place = server, server.new_study()
        self.killed_databases = 0
        with Study.open(self.place) as study:
            progress = StudyProgress(study)
            shipped = json.loads((STUDIES / "published-protocol.json").read_text())
            progress.set_protocol(StudyProtocol.from_json(shipped | PROTOCOL))
            for name in TRAINEES:
                study.create_trainee(name, consent=True)
                progress.enroll(name)
        self.seats = [
            Seat(folder / f"seat-{number}", self.place, nurseries, number)
            for number in range(SEATS)
        ]

    def is_next(self, trainee, name):
        with opened_when_available(self.place) as study:
            step = StudyProgress(study).played(trainee).next_step
        return step is not None and step.name == name

    def has_answered(self, trainee):
        """Answer the questionnaire if due; return whether it was done."""
        with opened_when_available(self.place) as study:
            progress = StudyProgress(study)
            progress.count_played(trainee)
            step = progress.progress(trainee).next_step
            if step is not None:
                progress.finish(trainee, step.name, {"answers": [3] * len(SUS.items)})
        return step is None

    def lead(self, seat_number):
        """Play the trials of one seat: trainees move on to the next seat for each task."""
        seat = self.seats[seat_number]
        trials = [
            (trainee, task)
            for number, task in enumerate(TASKS)
            for place, trainee in enumerate(TRAINEES)
            if (place + number) % SEATS == seat_number
        ]
        for index, (trainee, task) in enumerate(trials):
            patiently(lambda who=trainee, what=task: self.is_next(who, f"desktop/1/{what}"))
            left = KILLED_SIMULATORS - seat.killed_simulators
            seat.play(trainee, task, -(-left // (len(trials) - index)))
            if task == TASKS[-1]:
                patiently(lambda who=trainee: self.is_next(who, "desktop/after/sus"))
                patiently(lambda who=trainee: self.has_answered(who))
        while seat.killed_simulators < KILLED_SIMULATORS:
            seat.kill_simulator()
            seat.start_simulator()

    def kill_slicers(self, seat, rng):
        for _ in range(KILLED_SLICERS):
            time.sleep(rng.uniform(0.0, 8.0))
            seat.kill_slicer()

    def kill_databases(self, rng):
        for _ in range(KILLED_DATABASES):
            time.sleep(rng.uniform(0.0, 3.0))
            self.server.kill()
            self.killed_databases += 1
            time.sleep(rng.uniform(0.0, 0.5))
            self.server.start()

    def run(self):
        """Play the whole study while all is killed; then have everything scored and revealed."""
        with ThreadPoolExecutor(2 * SEATS + 1) as threads:
            parts = [threads.submit(self.lead, number) for number in range(SEATS)]
            parts += [
                threads.submit(self.kill_slicers, seat, random.Random(50 + number))
                for number, seat in enumerate(self.seats)
            ]
            parts.append(threads.submit(self.kill_databases, random.Random(60)))
            for part in parts:
                part.result()
        patiently(lambda: not any(find_unacknowledged(seat.records) for seat in self.seats))
        for seat in self.seats:
            # Late answers are asked for again over the next connection.
            seat.kill_slicer()
        patiently(lambda: all(trial.score and trial.truth for trial in self.trials()))

    def trials(self):
        with opened_when_available(self.place) as study:
            return [trial for name in TRAINEES for trial in study.history(name)]


def test_a_study_over_three_seats_survives_a_hundred_kills_of_all_its_parts(tmp_path):
    with (
        PostgresServer() as server,
        ForkServer(SIMULATOR, tmp_path) as simulators,
        ForkServer(STUDY_SIDE, tmp_path) as slicers,
    ):
        lab = Lab(tmp_path, server, (simulators, slicers))
        lab.run()
        killed = sum(seat.killed_simulators + seat.killed_slicers for seat in lab.seats)
        assert killed + lab.killed_databases >= KILLS
        check_trials(lab)
        check_progress(lab)
        file = tmp_path / "study.db"
        assert main(["copy-study", str(lab.place), str(file)]) == 0
        assert rows_of(lab.place) == rows_of(file)
        there, here = (
            written_files(where, tmp_path / name)
            for name, where in (("there", lab.place), ("here", file))
        )
        assert there == here


def check_trials(lab):
    """Each registered trial is in the study once, with the touches of its journal."""
    stored = lab.trials()
    names = [trial.record.trial_id for trial in stored]
    assert len(set(names)) == len(names) == len(TRAINEES) * len(TASKS)
    assert set(names) == set.union(*(seat.player.registered for seat in lab.seats))
    journals = {
        path.stem.partition("_")[2]: path
        for seat in lab.seats
        for path in seat.records.glob(f"*{SUFFIX}")
    }
    for trial in stored:
        reading = read_journal(journals[trial.record.trial_id])
        assert reading.integrity is Integrity.INTACT
        record = reading.of_kind("registered")[-1]["record"]
        found = [(point["label"], tuple(point["positionMm"])) for point in record["points"]]
        kept = [(point.label, tuple(point.position_mm)) for point in trial.record.points]
        assert kept == found
        assert len(kept) == 15


def check_progress(lab):
    """All trainees have done all steps in order, each once, at two seats."""
    with Study.open(lab.place) as study:
        progress = StudyProgress(study)
        for name in TRAINEES:
            entries = progress.progress(name).entries
            steps = [f"desktop/1/{task}" for task in TASKS]
            assert [entry.step for entry in entries] == [*steps, "desktop/after/sus"]
            assert [entry.outcome for entry in entries] == ["done"] * 3
            seats = [
                number
                for entry in entries[:2]
                for number, seat in enumerate(lab.seats)
                if entry.details["trialId"] in seat.player.registered
            ]
            assert len(set(seats)) == 2
        assert {trainee.pseudonym for trainee in study.trainees()} == set(TRAINEES)
