"""A study that is led over OpenIGTLink, as a view of the real simulator shows it to the trainee."""

from __future__ import annotations

from rastrainer.igtl.client import Client
from rastrainer.json_records import record_to_json
from rastrainer.number_text import with_units
from rastrainer.protocol import PROTOCOL_VERSION
from rastrainer.study.curriculum.curriculum import Curriculum
from rastrainer.study.curriculum.standing import standing_in
from rastrainer.study_messages import Assignment, StudyStep
from rastrainer.trial.trial_row import TrialRow
from Testing.end_to_end.simulator_process import MenuView, ViewedSimulator, items_of


def enabled(menu):
    return [name for name, item in items_of(menu).items() if "task" in name and item["isEnabled"]]


TWO = Curriculum(
    "c",
    "C",
    (Assignment("one", "task-1"), Assignment("two", "task-2", after=("one",))),
)
PASSED = TrialRow("T-001", "desktop", "task-1", values={"score": 80.0}, acceptable=True)


def curriculum(*trials):
    standing = standing_in(TWO, trials, lambda _version: 70.0)
    return record_to_json(standing.message("P08"))


def states(menu):
    return [item["value"] for item in menu["items"] if item["value"]]


def test_the_trainees_menu_offers_what_slicer_sends_of_a_study_and_of_a_curriculum(
    loop_thread, tmp_path
):
    hello = {"protocolVersion": PROTOCOL_VERSION, "client": "Slicer"}
    with (
        ViewedSimulator(tmp_path / "records") as simulator,
        Client(port=simulator.port) as slicer,
        MenuView(loop_thread, simulator) as view,
    ):

        def tell(name, content):
            return slicer.send_command(name, content, timeout=60)

        def tell_step(*step):
            assert tell("StudyStep", record_to_json(StudyStep("P07", *step))).ok

        assert tell("Hello", hello).ok
        tell_step("trial", 3, 19, "task-2", "desktop")
        view.go_to_experiment("P07")
        menu = view.until_menu("experiment", enabled)
        assert enabled(menu) == ["task-2"]
        assert "play Task 2" in menu["paragraphs"][0]
        tell_step("all-done", 19, 19)
        menu = view.until_menu("experiment", lambda menu: not enabled(menu))
        assert "All steps of the study are done" in menu["paragraphs"][0]
        refused = tell("StudyStep", {"trainee": "P07", "kind": "dance"})
        assert "kind must be one of questionnaire, trial-run" in refused.error
        assert tell("Curriculum", curriculum()).ok
        view.type("trainee", "P08")
        view.until_menu("experiment", lambda menu: "0 of 2 reached" in states(menu))
        assert states(view.go("assignments", "assignments")) == [with_units("0 / 1"), "locked"]
        assert tell("Curriculum", curriculum(PASSED)).ok
        menu = view.until_menu("assignments", lambda menu: "reached" in states(menu))
        assert states(menu) == ["reached", with_units("0 / 1")]
        refused = tell("Curriculum", {"trainee": "P08", "assignments": [{}]})
        assert 'assignments[0] needs the key "name"' in refused.error
        # The Slicer that comes next may have another study: what this one sent is forgotten.
        slicer.close()
        view.until_menu("experiment")
        with Client(port=simulator.port) as another:
            assert another.send_command("Hello", hello, timeout=60).ok
            for name in ("P09", "P08"):
                view.type("trainee", name)
                menu = view.until_menu(
                    "experiment",
                    lambda menu, name=name: items_of(menu)["trainee"]["value"] == name,
                )
            assert "assignments" not in items_of(menu)
