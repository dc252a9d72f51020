"""The methods of registration are compared in Slicer, on simulated trials of the chosen head."""

from __future__ import annotations

import json
import sys

import pytest

from rastrainer.errors import InputError
from rastrainer.sections.scenario_files import compareMethods
from rastrainer.sections.simulator_logic import SimulatorLogic
from rastrainer.work_progress import no_progress
from Testing.end_to_end.module.story import Story

TOLD = {
    "residual_mm": 0.5,
    "expected_tre_mm": 0.6,
    "interval_mm": [0.1, 1.2],
    "true_tre_mm": 0.7,
    "interval_holds_share": 0.95,
}
WRITES = """
import pathlib, sys
folder = pathlib.Path(sys.argv[sys.argv.index("-o") + 1])
folder.mkdir()
(folder / "methods.json").write_text({text!r})
print(" ".join(sys.argv[1:]))
"""


class Simulator(SimulatorLogic):
    """A simulator whose program writes a text as its comparison."""

    def __init__(self, text, script=WRITES):
        self._script = script.format(text=text)
        self.words = []

    def command(self, words):
        self.words = words
        return [sys.executable, "-c", self._script, *words]


def test_the_programs_output_is_read(scenario):
    simulator = Simulator(json.dumps({"methods": {"surface": TOLD, "scan": TOLD}}))
    numbers = (0.5, 0.7, 0.6, 0.95, 0.1, 1.2)
    assert compareMethods(simulator, scenario, 3, 2.0, no_progress) == {
        "surface": numbers,
        "scan": numbers,
    }
    given = dict(zip(simulator.words[1::2], simulator.words[2::2], strict=True))
    assert (given["--trials"], given["--skin-shift"]) == ("3", "2.0")


@pytest.mark.parametrize(
    ("text", "script", "said"),
    [
        ('{"methods": {"scan": {}}}', WRITES, "a different version"),
        ("", "print('rastrainer: The head has holes.'); exit(2)", "^The head"),
        ("", "exit(1)", "wrote nothing"),
    ],
    ids=["no numbers", "refused", "silent"],
)
def test_a_failed_comparison_is_reported_in_one_sentence(scenario, text, script, said):
    with pytest.raises(InputError, match=said):
        compareMethods(Simulator(text, script), scenario, 1, 0.0, no_progress)


@pytest.mark.soak
def test_every_method_is_compared_on_the_chosen_head_by_the_simulators_program(host, tmp_path):
    Story(host, tmp_path).choose_own_program()
    host.choose("scenarioComboBox", 0)
    host.find("methodsGroupBox").collapsed = False
    host.type("methodTrialsSpinBox", "1")
    host.type("methodShiftSpinBox", "2")
    host.press("compareMethodsButton")
    table = host.find("methodsTable")
    host.wait_until(lambda: table.rowCount == 6, "the methods are compared")
    names = [table.item(row, 0).text() for row in range(6)]
    assert names[:2] == ["Bone screws", "Fiducials"]
    true = [float(table.item(row, 2).text()) for row in range(6)]
    assert min(true) > 0.0
    assert "do not show which is better" in host.text("methodsText")
    assert host.messages == []
