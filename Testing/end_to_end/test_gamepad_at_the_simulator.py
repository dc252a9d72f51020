"""The ordinary server process, worked by a gamepad alone."""

from __future__ import annotations

from rastrainer.journal.journal_file import read_journal
from Testing.end_to_end.hands import GamepadHands
from Testing.end_to_end.lab import Lab
from Testing.end_to_end.window_process import wait_until


def test_a_gamepad_alone_begins_a_task_moves_the_arm_and_may_be_unplugged(tmp_path):
    with Lab(tmp_path, fine=5, order="fixed") as lab:
        simulator = lab.simulator
        trainee = lab.trainee(GamepadHands(simulator))
        trainee.begin("trial-run")
        trainee.press("touch", lambda: trainee.refused > 0, "a refused touch")
        wait_until(lambda: any(strength > 0 for strength, _ in simulator.felt()), "the vibration")
        assert {strength for strength, _ in simulator.felt()} <= {0.0, 45874 / 65535}
        simulator.move(leftx=0.8)
        trainee.until_moved()
        simulator.unplug()
        trainee.until_still()
        trainee.until_menu("trial")
        simulator.plug_in()
        trainee.resume()
        simulator.move(leftx=-0.8)
        trainee.until_moved()
        simulator.move(leftx=0.0)
        trainee.press("menu", lambda: trainee.menu is not None, "the menu")
        assert lab.operators == {"gamepad"}
        assert simulator.stop() == (0, "")
    (path,) = lab.records.glob("*.journal")
    header = read_journal(path).header
    assert (header.trainee, header.task, header.mode) == ("A", "trial-run", "desktop")
    assert header.settings["teleoperation"]["fineSpeed"] == 0.005
