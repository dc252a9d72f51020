"""`rastrainer verify` and `rastrainer replay` on journals of real trials, honest and forged."""

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from rastrainer.commands import CommandName, check_arguments
from rastrainer.files.writing import write_json
from rastrainer.journal.journal_file import SEED_SUFFIX, read_journal
from rastrainer.scenario.scenario import load_scenario
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.core.setup import scenario_sha256
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.record.journal_writer import Journal
from rastrainer_simulator.record.trial_archive import SUFFIX
from rastrainer_simulator.state import OperatorInput
from Testing.domain.procedure.made_up_procedure import write_planned

CHAIN = ("n", "previous", "sha256")


@pytest.fixture(scope="module")
def recorded(setup, tmp_path_factory) -> Path:
    """Return the journal of a short trial: sticks, a move, a refused touch, a pause, the abort."""
    folder = tmp_path_factory.mktemp("records")
    with ControlLoop(Simulation(setup, 5), folder, speed=None) as loop:

        def do(command, **arguments):
            return loop.submit(command, check_arguments(command, arguments)).result(120.0)

        do(CommandName.SET_CAMERA, camera="far")
        do(CommandName.START_TASK, task="task-2", trainee="P07", mode="hmd")
        x, y, z = (MM_PER_M * loop.latest.tool_tip_to_world[:3, 3]).tolist()
        do(CommandName.JOG, velocityMmS=[0, -80, 0], frame="camera", durationS=0.2)
        do(CommandName.MOVE_TIP_TO, positionMm=[x, y, z - 20.0], direction=[0, 0.1, -1])
        do(CommandName.CAPTURE)
        until = loop.latest.tick + 60
        loop.hold_sticks(OperatorInput((0.1, 0.9, -0.4), fine=True, operator="gamepad"))
        while loop.latest.tick < until:
            do(CommandName.LIST_TASKS)
        do(CommandName.PAUSE)
        do(CommandName.RESUME)
        do(CommandName.ABORT)
    (path,) = folder.glob(f"*{SUFFIX}")
    return path


def open_copy(recorded: Path, tmp_path: Path) -> Path:
    """Return the path of a copy to be cut; its seed is next to it, as for an open trial."""
    seed = read_journal(recorded).header.seed
    (tmp_path / "cut").with_suffix(SEED_SUFFIX).write_text(str(seed))
    return tmp_path / "cut"


def forged(recorded: Path, tmp_path: Path, change) -> Path:
    """Return a copy with changed entries, under hashes that are right."""
    entries = [
        {key: value for key, value in entry.items() if key not in CHAIN}
        for entry in read_journal(recorded).entries
    ]
    change(entries)
    journal = Journal(tmp_path / "forged.journal")
    journal.write(entries, sync=False)
    journal.close()
    return journal.path


def test_an_untouched_journal_is_intact_and_replays_to_the_last_bit(recorded, capsys):
    assert main(["verify", str(recorded)]) == 0
    assert "intact" in capsys.readouterr().out
    assert main(["replay", str(recorded), "--verify"]) == 0
    assert "equal to the last bit" in capsys.readouterr().out


def test_cut_short_altered_and_foreign_files_are_distinguished_by_message_and_status(
    recorded, tmp_path, capsys
):
    data = recorded.read_bytes()
    cut, altered, foreign = (tmp_path / name for name in ("cut", "altered", "foreign"))
    cut.write_bytes(data[:-100])
    altered.write_bytes(data.replace(b'"P07"', b'"P08"', 1))
    foreign.write_bytes(b"label,x,y,z\n")
    assert main(["verify", str(recorded), str(cut)]) == 1
    assert "cut short: recovered up to line" in capsys.readouterr().out
    assert main(["verify", str(altered)]) == 1
    assert "altered: line 1 " in capsys.readouterr().out
    assert main(["verify", str(foreign)]) == 2
    assert main(["verify", str(tmp_path / "missing")]) == 2
    said = capsys.readouterr().err
    assert "not a trial's journal" in said
    assert "cannot be read" in said


def test_a_journal_cut_between_two_lines_of_one_tick_replays_up_to_there(recorded, tmp_path):
    lines = recorded.read_bytes().splitlines(keepends=True)
    ticks = [json.loads(line).get("tick") for line in lines]
    shared = next(n for n in range(20, len(ticks)) if ticks[n] == ticks[n - 1])
    cut = open_copy(recorded, tmp_path)
    cut.write_bytes(b"".join(lines[:shared]) + lines[shared][:10])
    assert main(["replay", str(cut), "--verify"]) == 0


def test_a_forgery_with_valid_hashes_is_detected_by_the_replay(recorded, tmp_path, capsys):
    def moved_sample(entries):
        sample = [entry for entry in entries if entry["kind"] == "sample"][5]
        sample["q"][0] += 1e-12

    def missing_event(entries):
        entries.remove(next(entry for entry in entries if entry["kind"] == "rejected"))

    other_stick = set_in("input", translation=[0.1, 0.9, -0.41])
    for change in (moved_sample, other_stick, missing_event):
        path = forged(recorded, tmp_path, change)
        assert main(["verify", str(path)]) == 0
        assert main(["replay", str(path), "--verify"]) == 1
        assert "line" in capsys.readouterr().out
        path.unlink()


def set_in(kind, **values):
    def change(entries):
        [entry for entry in entries if entry["kind"] == kind][-1].update(values)

    return change


@pytest.mark.parametrize(
    "change",
    [
        set_in("aborted", tick=10**12),
        set_in("header", tickS=0.0),
        set_in("header", before={"tick": "x"}),
        set_in("header", settings={"teleoperation": {"coarse_speed": "fast"}}),
        set_in("header", scenario={"name": "other", "sha256": "0" * 64}),
        set_in("input", translation=["a", "b", "c"]),
        set_in("command", name="Jog", arguments={"velocityMmS": [1e9, 0, 0]}),
    ],
)
def test_a_hostile_journal_gives_one_sentence_and_status_2(recorded, tmp_path, change, capsys):
    path = forged(recorded, tmp_path, change)
    assert main(["replay", str(path), "--verify"]) == 2
    said = capsys.readouterr().err
    assert said.startswith("rastrainer: ")
    assert "Traceback" not in said


RECORDED_BEFORE = "8ea38ba4bfc46979ba0138ec6bce0c89536b8d9f4066b18be7c9018ccf2420aa"
"""The default scenario when it had neither volume nor skull and procedures."""


def test_a_journal_from_before_the_default_head_had_volume_and_procedures_still_matches_it(setup):
    assert setup.scenario.volume is not None
    assert setup.scenario.procedures
    assert setup.scenario_sha256 == RECORDED_BEFORE


def test_a_journal_still_matches_a_scenario_to_which_skull_and_procedures_were_added(tmp_path):
    planned = write_planned(tmp_path / "planned")
    with_procedures = scenario_sha256(load_scenario(planned))
    path = planned / "scenario.json"
    values = json.loads(path.read_text(encoding="utf-8"))
    del values["procedures"]
    write_json(path, values)
    assert scenario_sha256(load_scenario(planned)) == with_procedures
    del values["skull"]
    write_json(path, values)
    assert scenario_sha256(load_scenario(planned)) == with_procedures


def test_a_journal_of_another_scenario_or_robot_is_refused(setup):
    here = setup.recorded()
    assert setup.difference(SimpleNamespace(**here)) == ""
    other = {**here, "scenario": replace(here["scenario"], sha256="0" * 64)}
    assert setup.difference(SimpleNamespace(**other)) == "scenario"
    assert setup.difference(SimpleNamespace(**{**here, "robot": "another"})) == "robot"
