"""How many functions are called on the three walks of `docs/design.md`, in all processes."""

from __future__ import annotations

import contextlib
import dataclasses
import io
import os
import subprocess
import sys
import tempfile
import time
import uuid
from collections.abc import Iterator
from pathlib import Path

RECORDER = Path(__file__).with_name("recorder")
CALLED = "RASTRAINER_CALLED"
PUSH_S = 1.0
WALKS = ("stick to wire", "touch to score", "trial to report")
STUDY_TRIALS = 40


def print_walks() -> None:
    """Print the number of functions and files of each walk."""
    for number, title in enumerate(WALKS):
        with tempfile.TemporaryDirectory() as folder:
            environment = {
                **os.environ,
                CALLED: folder,
                "PYTHONPATH": os.pathsep.join([str(RECORDER), os.environ.get("PYTHONPATH", "")]),
                "HOME": folder,
            }
            subprocess.run(
                [sys.executable, "-m", "Testing.code_size.walks", str(number), folder],
                check=True,
                env=environment,
            )
            called = {
                line
                for path in Path(folder).glob("called-*.txt")
                for line in path.read_text(encoding="utf-8").splitlines()
                if "/Testing/" not in line
            }
        files = {line.split("\t")[0] for line in called}
        print(f"{title:20}{len(called):6} functions in {len(files):4} files")


@contextlib.contextmanager
def recording() -> Iterator[None]:
    """Have all processes note the functions that they call meanwhile."""
    switch = Path(os.environ[CALLED], "recording")
    switch.touch()
    time.sleep(0.1)
    yield
    time.sleep(0.1)
    switch.unlink()
    time.sleep(0.3)


def walk_from_stick_to_wire(folder: Path) -> None:
    """Push the stick of a page's pad for a second, with one client and one view."""
    from rastrainer.igtl.client import Client
    from rastrainer_simulator.virtual.scripted_trial import send_hello
    from Testing.end_to_end.simulator_process import ViewedSimulator
    from Testing.simulator.net.igtl.servers import LoopThread
    from Testing.simulator.net.views.served import ViewClient

    with (
        ViewedSimulator(folder / "records") as simulator,
        LoopThread() as thread,
        ViewClient(thread, simulator.url, simulator.key) as view,
        Client(port=simulator.port) as client,
    ):
        view.join()
        send_hello(client, "player")
        _send(client, "StartTask", task="task-1", trainee="T-001")
        view.send({"type": "picture", "task": "task-1", "share": 1.0})
        _push(view, 0.0, 0.5)
        with recording():
            _push(view, 0.8, PUSH_S)


def _push(view, amount: float, seconds: float) -> None:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        axes = [0.0, -amount, 0.0, 0.0]
        view.send({"type": "pad", "axes": axes, "buttons": [0.0] * 17})
        time.sleep(0.02)


def _send(link, name: str, **arguments: object) -> None:
    reply = link.send_command(name, arguments, timeout=60)
    assert reply.ok, f"{name}: {reply.error}"


def walk_from_touch_to_score(folder: Path) -> None:
    """Capture the last fiducial and register, with the module in its host and without views."""
    from Testing.end_to_end.module.story import Story
    from Testing.slicer.host.host import Host

    host = Host(folder / "slicer")
    story = Story(host, folder)
    try:
        story.choose_own_program()
        for step in (
            story.start_simulator,
            story.create_trainee,
            story.show_scenario,
            story.start_task,
        ):
            step()
        story.touch(1, 14)
        story.player.lower(15)
        host.wait_until(lambda: story.player.is_done, "the tip is on point 15")
        with recording():
            story.player.capture()
            host.wait_until(lambda: story.player.is_done, "point 15 is touched")
            story.register()
        assert host.errors == []
    finally:
        host.close()


def walk_from_trial_to_report(folder: Path) -> None:
    """Store a trial in a study, and write the report of a study of 40 trials."""
    from rastrainer.study.database.study import Study
    from rastrainer.study.protocol.study_protocol import StudyProtocol
    from rastrainer_simulator.cli.main import main
    from rastrainer_simulator.virtual.play import PlaySettings, play_job
    from rastrainer_simulator.virtual.population import Population, trial_jobs

    protocol = StudyProtocol("walk", "Walk", ("desktop", "hmd"), "balanced", ("task-1",), "fixed")
    jobs = trial_jobs(protocol, Population(), 1, 0)
    trial = next(one for one in (play_job(job, PlaySettings()).analysis for job in jobs) if one)
    path = folder / "study.db"

    def store(study: Study, number: int) -> None:
        record = dataclasses.replace(
            trial.record,
            trial_id=str(uuid.UUID(int=number + 1)),
            trainee=f"T-{number // 4:03d}",
            mode=("desktop", "hmd")[number % 2],
            completion_time_s=trial.record.completion_time_s + number,
        )
        study.add_trial(record, trial.fits.values(), trial.target_errors, trial.score)

    with Study.open(path) as study:
        for number in range(STUDY_TRIALS - 1):
            if number % 4 == 0:
                study.create_trainee(f"T-{number // 4:03d}", consent=True)
            store(study, number)
        with recording():
            store(study, STUDY_TRIALS - 1)
            with contextlib.redirect_stdout(io.StringIO()):
                assert main(["report", str(path), "-o", str(folder / "report")]) == 0


if __name__ == "__main__":
    walks = walk_from_stick_to_wire, walk_from_touch_to_score, walk_from_trial_to_report
    walks[int(sys.argv[1])](Path(sys.argv[2]))
