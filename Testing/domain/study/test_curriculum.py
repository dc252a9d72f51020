"""A curriculum: its file, goals, gates, and which assignment comes next."""

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from rastrainer.commands import CommandName, check_arguments, decode_json_object
from rastrainer.errors import InputError
from rastrainer.json_records import record_to_json
from rastrainer.protocol import MAX_ASSIGNMENTS, MAX_GATES, AssignmentState, GoalKind
from rastrainer.study.curriculum.curriculum import Curriculum
from rastrainer.study.curriculum.curriculum_store import CurriculumStore
from rastrainer.study.curriculum.standing import standing_in
from rastrainer.study.protocol.study_progress import StudyProgress
from rastrainer.study.protocol.study_protocol import StudyProtocol
from rastrainer.study.trainee_data import export_trainee
from rastrainer.study_messages import Assignment, CurriculumMessage
from rastrainer.trial.trial_row import TrialRow
from Testing.domain.trial.trial_records import gentle_score, make_aborted, make_record

SHIPPED = Path(__file__).parents[3] / "assets" / "studies" / "example-curriculum.json"
LOCKED, OPEN, REACHED = AssignmentState.LOCKED, AssignmentState.OPEN, AssignmentState.REACHED
PASSED = TrialRow("T-001", "desktop", "task-1", values={"score": 80.0}, acceptable=True)
FAILED = replace(PASSED, values={"score": 50.0})
ABORTED = replace(PASSED, values={}, acceptable=False, is_aborted=True)
ONE = Assignment("one", "task-1", trials=2)
TWO = Assignment("two", "task-2", trials=1, after=("one",))


def stand(trials, *assignments):
    curriculum = Curriculum("c", "C", assignments or (ONE, TWO))
    return standing_in(curriculum, trials, lambda _assignment: 70.0)


def states(trials, *assignments):
    return [each.state for each in stand(trials, *assignments).standings]


def file_with(**changes):
    first = {"name": "one", "task": "task-1", "goal": "score", "trials": 2}
    whole = {"formatVersion": 1, "name": "c", "title": "C", "assignments": [first]}
    return {**whole, **changes}


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"task": "trial-run"}, "task must be a task that is scored"),
        ({"goal": "competent", "trials": 3}, "trials must be left out"),
        ({"after": ["one"]}, "after must be a list of assignments that stand before"),
    ],
)
def test_an_invalid_assignment_is_refused_with_the_field(changes, said):
    first = file_with()["assignments"][0]
    with pytest.raises(InputError, match=said):
        Curriculum.from_json(file_with(assignments=[{**first, **changes}]))
    with pytest.raises(InputError, match="one that no other assignment has"):
        Curriculum.from_json(file_with(assignments=[first, first]))


def test_a_score_goal_is_reached_by_consecutive_trials_and_stays_reached():
    assert states([]) == [OPEN, LOCKED]
    assert states([PASSED, FAILED, PASSED]) == [OPEN, LOCKED]
    one = stand([PASSED, FAILED, PASSED]).standings[0]
    assert (one.done, one.needed, one.played) == (1, 2, 3)
    assert states([PASSED, PASSED, FAILED, FAILED]) == [REACHED, OPEN]
    assert stand([PASSED, PASSED, FAILED]).standings[0].done == 2
    # Trials of a locked assignment count once its gate is open.
    second = replace(PASSED, task="task-2")
    assert states([second]) == [OPEN, LOCKED]
    assert states([second, PASSED, PASSED]) == [REACHED, REACHED]
    beyond = replace(PASSED, acceptable=False)
    assert states([beyond], replace(ONE, trials=1)) == [OPEN]


def test_only_trials_that_match_the_assignment_count():
    in_headset = replace(ONE, mode="hmd", trials=1)
    by_surface = replace(ONE, method="surface", trials=1)
    biopsy = replace(ONE, procedure="biopsy", trials=1)
    on_egg = replace(ONE, scenario="egg", trials=1)
    assert states([PASSED], on_egg) == [OPEN]
    assert states([replace(PASSED, scenario="egg")], on_egg) == [REACHED]
    assert states([PASSED], in_headset) == [OPEN]
    assert states([replace(PASSED, mode="hmd")], in_headset) == [REACHED]
    assert states([PASSED], by_surface) == [OPEN]
    surface = replace(PASSED, method="surface")
    assert states([surface], by_surface) == [REACHED]
    assert states([surface], replace(ONE, trials=1)) == [OPEN]
    assert states([PASSED], biopsy) == [OPEN]
    outcome = SimpleNamespace(analysis=SimpleNamespace(procedure="biopsy"))
    done = replace(PASSED, procedure=outcome)
    assert states([done], biopsy) == [REACHED]
    assert states([done], replace(ONE, trials=1)) == [OPEN]


def test_a_bad_trial_cannot_be_undone_by_aborting_it():
    assert states([PASSED, ABORTED, PASSED]) == [OPEN, LOCKED]
    assert stand([PASSED, ABORTED]).standings[0].done == 0
    assert stand([PASSED, ABORTED]).standings[0].mean == 40.0
    in_procedure = replace(ABORTED, is_in_procedure=True)
    assert states([PASSED, in_procedure, PASSED]) == [REACHED, OPEN]


def test_a_goal_without_a_mark_uses_that_of_the_study_and_is_never_reached_without_one():
    curriculum = Curriculum("c", "C", (replace(ONE, trials=1),))
    found = standing_in(curriculum, [PASSED], lambda _assignment: None)
    assert (found.standings[0].state, found.standings[0].mark) == (OPEN, None)
    own = Curriculum("c", "C", (replace(ONE, trials=1, mark=75.0),))
    assert standing_in(own, [PASSED], lambda _assignment: None).reached == 1
    both = Curriculum("c", "C", (*curriculum.assignments, replace(ONE, name="own", mark=90.0)))
    assert standing_in(both, [], lambda _assignment: None).next_best.name == "own"


def test_an_assignment_that_the_mark_of_the_study_could_never_reach_is_refused(study):
    published = StudyProtocol.read(SHIPPED.with_name("published-protocol.json"))
    marked = replace(published, pass_mark=80.0)
    StudyProgress(study).set_protocol(marked)
    store = CurriculumStore(study)
    with pytest.raises(InputError, match="biopsy could never be reached"):
        store.choose(Curriculum.read(SHIPPED))
    assert store.choices() == ()
    store.choose(Curriculum("c", "C", (ONE, replace(TWO, procedure="biopsy", mark=60.0))))
    assert [each.mark for each in store.standing("A").standings] == [80.0, 60.0]


def test_an_lc_cusum_goal_is_reached_at_competence_and_reports_its_progress():
    competent = replace(ONE, goal=GoalKind.COMPETENT, trials=1)
    shares = [stand([PASSED] * count, competent).standings[0].done for count in range(30)]
    assert shares == sorted(shares)
    assert shares[0] == 0
    assert shares[-1] == 100
    first = shares.index(100)
    assert states([PASSED] * first, competent) == [REACHED]
    assert states([PASSED] * (first - 1), competent) == [OPEN]
    assert states([PASSED] * (first - 1) + [FAILED], competent) == [OPEN]


def test_the_weakest_open_assignment_comes_next_and_an_unplayed_one_before_it():
    three = [Assignment(name, f"task-{name}", trials=2) for name in ("1", "2", "3")]
    assert stand([], *three).next_best.name == "1"
    first = stand([replace(PASSED, values={"score": 60.0})], *three)
    assert first.next_best.name == "2"
    scores = {"1": 60.0, "2": 40.0, "3": 90.0}
    trials = [
        replace(PASSED, task=f"task-{n}", values={"score": score}) for n, score in scores.items()
    ]
    assert stand(trials, *three).next_best.name == "2"
    marked = [three[0], three[1], replace(three[2], mark=99.0)]
    assert stand(trials[::2], marked[0], marked[2]).next_best.name == "1"


@pytest.fixture
def study(study):
    study.create_trainee("A")
    study.create_trainee("B")
    return study


def test_the_latest_choice_counts_whether_for_one_trainee_or_for_everybody(study, tmp_path):
    store = CurriculumStore(study)
    first, second = (Curriculum(name, name, (ONE,)) for name in ("first", "second"))
    assert store.standing("A") is None
    store.choose(first)
    store.choose(second, "A")
    assert [store.standing(name).curriculum for name in "AB"] == [second, first]
    study.create_trainee("later")
    assert store.standing("later").curriculum == first
    store.choose(None, "B")
    assert list(store.standings()) == ["A", "later"]
    store.choose(first)
    assert [store.standing(name).curriculum for name in "AB"] == [first, first]
    export_trainee(study, "A", tmp_path / "a.json")
    (exported,) = json.loads((tmp_path / "a.json").read_text(encoding="utf-8"))["curricula"]
    assert exported["curriculum"]["name"] == "second"
    chosen = [(name, curriculum) for name, curriculum, _utc in store.choices()]
    assert chosen == [("", first), ("A", second), ("B", None), ("", first)]
    with pytest.raises(InputError, match="no trainee"):
        store.choose(first, "C")
    study.delete_trainee("A")
    assert [name for name, _curriculum, _utc in store.choices()] == ["", "B", ""]


def record(number, **changes):
    utc = f"2024-05-17T10:{number:02d}:00Z"
    values = {"trainee": "A", "startedUtc": utc, "completedUtc": utc}
    return make_record(number, **(values | changes))


def test_stored_trials_count_in_order_of_starting_and_aborted_ones_as_failures(study):
    good = gentle_score(60.0, 0.2)
    assert good.score > 70
    study.add_trial(record(3), score=good)
    study.add_trial(record(1), score=good)
    study.add_trial(record(4, task="trial-run"), score=good)
    study.add_trial(record(5))
    at = {"trainee": "A", "startedUtc": "2024-05-17T10:02:00Z"}
    study.add_aborted(make_aborted(**at))
    found = study.attempts("A")
    assert [trial.is_aborted for trial in found] == [False, True, False]
    assert found[0].parts["common bias"] == 1.0
    store = CurriculumStore(study)
    before = store.stamps()
    store.choose(Curriculum("c", "C", (ONE, TWO)))
    chosen = store.stamps()
    assert [before[name] == chosen[name] for name in ("A", "B")] == [False, False]
    assert (store.standing("A").standings[0].done, store.standing("A").reached) == (1, 0)
    study.add_trial(record(6), score=good)
    assert store.standing("A").reached == 1
    assert store.stamps()["A"] != chosen["A"]
    assert store.stamps()["B"] == chosen["B"]
    assert store.standing("B").reached == 0


def told_of(trials, *assignments):
    arguments = record_to_json(stand(trials, *assignments).message("A"))
    return check_arguments(CommandName.CURRICULUM, json.loads(json.dumps(arguments)))


def test_what_slicer_sends_to_the_simulator_arrives_unchanged_and_fits_into_a_message():
    checked = told_of([PASSED])
    assert CurriculumMessage(**checked) == stand([PASSED]).message("A")
    none = check_arguments(CommandName.CURRICULUM, record_to_json(CurriculumMessage("A")))
    assert CurriculumMessage(**none) == CurriculumMessage("A")
    names = [f"{number:02d}{'x' * 38}" for number in range(MAX_ASSIGNMENTS)]
    largest = [
        Assignment(
            *(name, name, name, "desktop", "landmarks-surface", name),
            trials=50,
            after=tuple(names[max(0, place - MAX_GATES) : place]),
        )
        for place, name in enumerate(names)
    ]
    whole = record_to_json(stand([], *largest).message("A" * 64))
    decode_json_object(json.dumps(whole))
    assert len(json.dumps(whole)) < 20_000
