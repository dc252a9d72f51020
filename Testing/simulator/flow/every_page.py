"""Every menu, page and dialog that the flow can open, as the screens that views draw."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Future
from dataclasses import replace
from functools import partial
from importlib import import_module
from pkgutil import iter_modules
from types import MappingProxyType, SimpleNamespace
from unicodedata import east_asian_width

import numpy as np
import pytest

from rastrainer.decision.drill_record import Decision, Fault
from rastrainer.procedure.plan import ProcedureKind
from rastrainer.procedure.record import UsedRegistration
from rastrainer.protocol import MAX_ASSIGNMENTS, AssignmentState, GoalKind, Phase
from rastrainer.registration.fits import RIGID
from rastrainer.study.ratings import FORMS
from rastrainer.study_messages import AssignmentStanding, CurriculumMessage, StudyStep
from rastrainer_simulator.decision.cases import CaseMaker
from rastrainer_simulator.flow import pages, procedure_screen, trial_screen
from rastrainer_simulator.flow.flow_presenter import FlowPresenter
from rastrainer_simulator.flow.pages import (
    case,
    controls,
    experiment,
    introduction,
    result,
    start,
    trainee_id,
    trial_review,
)
from rastrainer_simulator.flow.pages.trial_review import MOST_TRIALS
from rastrainer_simulator.flow.session.open_pages import OpenPages, Page
from rastrainer_simulator.flow.session.preferences import InstructorLock
from rastrainer_simulator.flow.session.trainee_history import OwnTrial
from rastrainer_simulator.input.inputs import ControlName, InputDevice
from rastrainer_simulator.presentation.screen import Screen, without_secrets
from rastrainer_simulator.rating.rating_presenter import domain_page, loading_page, rated_page
from rastrainer_simulator.record.trial_context import TutorialOutcome
from rastrainer_simulator.state import TrainingState, TrialResult
from rastrainer_simulator.texts.texts import LANGUAGES
from rastrainer_simulator.trial_state import (
    PlannedLine,
    ProcedureState,
    TouchState,
    TrajectoryState,
)
from Testing.drawn_drills import draw_drill
from Testing.simulator.report.studied_procedures import outcome

QUESTIONNAIRE = StudyStep("P07", "questionnaire", 2, 19, questionnaire="nasa-tlx")
FAILED = {
    "isAccurate": False,
    "isUnbiased": False,
    "isSafe": False,
    "scoredBySimulator": True,
    "residualsMm": [5.12],
    "regionTreMm": 2.91,
    "commonBiasMm": 1.83,
    "contactTimeS": 9.4,
    "contactPathMm": 171.0,
    "pressingDepthMm": 2.1,
    "feedback": [
        {
            "key": "touch",
            "text": "Point 12 was off.",
            "values": {
                "label": "12",
                "residual": 5.12,
                "where": {"key": "touch aside", "text": ""},
                "hurry": {"key": "touch hurry", "text": ""},
                "shaking": "",
            },
        },
        {"key": "depth", "text": "Most of the error is in depth.", "values": {}},
        {"key": "first trial", "text": "This is your first trial.", "values": {}},
    ],
}
"""Details of a trial beyond every limit: nothing is longer."""
SCORED = TrainingState(
    phase=Phase.SCORED,
    trainee="P07",
    task="task-1",
    mode="desktop",
    trial_id="none",
    touches=(TouchState("12", (0.0, 0.0, 0.0), 183.2, 183.2),),
    result=TrialResult(UsedRegistration((1.0,) * 16, 1.25, 1.5), 1.4, 0.0, FAILED),
)

AT_PROCEDURE = replace(
    SCORED, phase=Phase.ALIGNING, result=None, procedure=ProcedureState("biopsy", Phase.VERIFYING)
)
PROCEDURE_SCORED = replace(
    SCORED,
    touches=(),
    procedure=ProcedureState(
        "biopsy",
        Phase.REGISTERED,
        trajectories=(TrajectoryState(PlannedLine("Lesion", (0.5, 0.0, 0.4), (0.5, 0.0, 0.3))),),
    ),
    result=replace(SCORED.result, details={"procedure": outcome(ProcedureKind.BIOPSY).summary()}),
)
PROCEDURE_SCORED.result.details["procedure"]["trajectories"][0].update(
    name="Right frontal lesion", nearest="Superior sagittal sinus (schematic)"
)

OWN_TRIALS = tuple(
    OwnTrial(
        *("T-001", "desktop", "task-1"),
        values={"score": 61.0 + number},
        trial_id=f"trial-{number}",
        acceptable=True,
        scenario="test-head",
        started_utc=f"2026-11-{number + 1:02d}T15:04:05Z",
        is_passed=number % 2 == 0,
    )
    for number in range(MOST_TRIALS)
)
LEARNED = TutorialOutcome(
    trainee="P07",
    device="gamepad",
    mode="desktop",
    duration_s=112.0,
    first_error_mm=2.34,
    errors_mm=(1.2, 0.8, 0.6),
)


class _SetPin:
    """A PIN that is set, and that no one guesses."""

    is_set = True


def known_match(share: float, expected_mm: float, interval_mm: tuple, *wrong: str) -> Future:
    """Return a match with its figures; `wrong` are the codes of what looks wrong with it."""
    warnings = [SimpleNamespace(code=code) for code in wrong]
    slide = SimpleNamespace(distance_mm=4.2)
    match = SimpleNamespace(rms_mm=0.42, inlier_share=share, slide=slide, warnings=warnings)
    at_target = SimpleNamespace(expected_mm=expected_mm, interval_mm=interval_mm)
    matched: Future = Future()
    matched.set_result(SimpleNamespace(match=match, target_errors={RIGID: at_target}))
    return matched


def _matched() -> Future:
    """Return a match with most of the possible warnings: the page with the longest text."""
    return known_match(0.71, 2.31, (1.12, 5.55), "slides", "several-minima", "few-inliers")


class _Loading:
    """A trial that is never loaded."""

    trial: Future = Future()


def every_screen(presenter: FlowPresenter) -> dict[str, Screen]:
    """Return a screen of each page, by the name of its menu, and the screen of a running trial."""
    session, flow = presenter._session, presenter._flow
    session.trainee = "P07"
    session.state = replace(session.state, training=SCORED)
    screens = {"": Screen(status=("Task 1",))}
    for page in _pages(session):
        session.pages.show(page)
        screens[page.name] = flow.screen()
    lock, session.lock = session.lock, InstructorLock(_SetPin())
    session.pages.show(start.settings_page(session))
    screens["locked settings"] = flow.screen()
    screens["somebody else's PIN"] = without_secrets(screens["pin"])
    # A view that does not operate is sent nothing else.
    screens["pin"] = replace(screens["pin"], is_private=False)
    session.lock = lock
    session.pages.show_start()
    return screens | _screens_of_raters(session.texts, session.preferences.language)


class _Rated:
    """The work of a rater, as far as pages show it."""

    place, trial_ids, forms, rated = 4, ("trial",) * 20, tuple(FORMS.values()), 5
    marks = MappingProxyType({d.name: 4 for form in FORMS.values() for d in form.domains})


class _Desk:
    """A rater's desk, as far as pages show it."""

    work = _Rated()
    undo = load = leave = None

    def __init__(self, texts):
        self.say = partial(texts.say, number=5, count=20)


def _screens_of_raters(texts, language: str) -> dict[str, Screen]:
    """Return the pages of the form with the longest words, of the marks, and of waiting."""
    desk = _Desk(texts)
    form = FORMS["osats"]
    rater_pages = (
        domain_page(desk, form, form.domains[-1]),
        rated_page(desk),
        loading_page(desk, _Loading.trial),
    )
    screens = {}
    for page in rater_pages:
        open_pages = OpenPages(lambda _feedback: None)
        open_pages.open(page)
        screens[page.name] = Screen(menu=open_pages.menu(), language=language)
    return screens


def names_of_pages() -> set[str]:
    """Return the names of all existing pages."""
    names = (each.name for each in iter_modules(pages.__path__, f"{pages.__name__}."))
    modules = (trial_screen, procedure_screen, *map(import_module, names))
    found = [value for module in modules for value in vars(module).values()]
    return {v.name for v in found if isinstance(v, type) and issubclass(v, Page) and v.name}


def with_curriculum(session) -> None:
    """Give the trainee a curriculum with as many assignments as there may be, and long titles."""
    assignment = AssignmentStanding(
        *("long", "task-5", "", "hmd", "landmarks-surface"),
        goal=GoalKind.COMPETENT,
        state=AssignmentState.OPEN,
        needed=100,
    )
    others = [
        replace(assignment, name=f"n{number}", state=AssignmentState(state))
        for number, state in enumerate(("reached", "locked") * ((MAX_ASSIGNMENTS - 1) // 2))
    ]
    longest = replace(assignment, procedure="biopsy", played=3, mark=70.0, weakest="distance")
    session.services.assigned.take_curriculum(
        CurriculumMessage("P07", "The first weeks " * 5, "long", (longest, *others))
    )
    session.services = replace(session.services, is_slicer_connected=lambda: True)


def _pages(session) -> Iterator[Page]:
    keys, touch = InputDevice.KEYBOARD, ControlName.TOUCH
    for simple in (start.start_page, start.quit_page, start.settings_page):
        yield simple(session)
    yield start.PinPage(session)
    yield introduction.introduction_page(session)
    yield controls.controls_page(session)
    yield controls.pad_test_page(session)
    yield controls.bindings_page(session, device=keys)
    yield controls.listen_page(session, keys, touch)
    yield controls.conflict_page(session, keys, touch, "KeyC")
    with_curriculum(session)
    yield experiment.ExperimentPage(session)
    yield experiment.assignments_page(session)
    yield experiment.DecidePage(session)
    yield from _drill_pages(session)
    yield trainee_id.keyboard_page(session, lambda *_: None)
    yield trainee_id.clicked_id_page(session, lambda *_: None)
    yield trainee_id.character_page(session, lambda *_: None, trainee_id.ROWS[0])
    yield experiment.scenario_page(session, session.services.list_scenarios())
    yield trainee_id.questionnaire_page(session, QUESTIONNAIRE)
    for over_a_trial in (
        trial_screen.trial_page,
        trial_screen.preparing_page,
        trial_screen.abort_page,
        trial_screen.practice_page,
        trial_screen.complete_page,
    ):
        yield over_a_trial(session)
    yield trial_screen.match_page(session, _matched())
    yield result.waiting_page(session)
    yield result.ResultPage(session)
    # No trial has been played here in which the point could lie.
    session.state = replace(session.state, training=replace(SCORED, touches=()))
    yield trial_review.ErrorsPage(session)
    session.state = replace(session.state, training=AT_PROCEDURE)
    yield procedure_screen.procedure_page(session)
    session.state = replace(session.state, training=PROCEDURE_SCORED)
    yield result.procedure_errors_page(session)
    yield trial_review.ErrorsPage(session, has_lines=True)
    session.state = replace(session.state, training=SCORED)
    yield introduction.tutorial_page(session)
    yield introduction.tutorial_done_page(session, LEARNED)
    yield introduction.practiced_page(session, LEARNED)
    session.history.own = lambda _trainee: OWN_TRIALS
    yield trial_review.own_trials_page(session)
    yield trial_review.ReplayPage(session, _Loading(), begins_at_worst=False)


_CASES = {}


def _case(scenario):
    """Return a case with many points, made once for each scenario."""
    if scenario.name not in _CASES:
        maker = CaseMaker(scenario)
        made = (maker.case(seed, Fault.BAD_FIDUCIAL) for seed in range(20))
        _CASES[scenario.name] = max(made, key=lambda each: len(each.labels))
    return _CASES[scenario.name]


def _drill(scenario, is_decided: bool) -> SimpleNamespace:
    """Return a drill at its last case, as far as pages show it."""
    made = _case(scenario)
    cases = draw_drill(np.random.default_rng(1), "P07").cases
    mirrored = {"fault": Fault.MIRRORED, "suspected": Fault.MIRRORED}
    decided = [*cases, replace(cases[0], **mirrored, decision=Decision.PROCEED, confidence=100)]
    return SimpleNamespace(
        case=made,
        number=20,
        count=20,
        left_s=7.0,
        checks=tuple(made.places),
        is_ready=True,
        is_over=True,
        is_finished=True,
        cases=decided,
        decided=decided[-1] if is_decided else None,
    )


def _drill_pages(session) -> Iterator[Page]:
    yield case.introduction_page(session)
    session.drill = _drill(session.scenario, is_decided=False)
    yield case.case_page(session)
    yield case.places_page(session)
    yield case.images_page(session, session.drill.case.target_mm)
    yield case.decision_page(session)
    yield case.confidence_page(session, Decision.PROCEED)
    yield case.suspect_page(session, Decision.STOP, 50)
    yield case.leave_page(session)
    session.drill = _drill(session.scenario, is_decided=True)
    yield case.truth_page(session)
    yield case.drill_result_page(session, session.drill.cases)
    session.drill = None


LONGEST = "longest"
"""Each screen in the language that has the most letters on it."""
LONGEST_OR_EACH = [LONGEST, *(pytest.param(tag, marks=pytest.mark.soak) for tag in LANGUAGES)]


def screens_in(presenter: FlowPresenter, language: str) -> dict[str, Screen]:
    """Return a screen of each page in a language."""
    presenter._session.prefer(language=language)
    return every_screen(presenter)


def longest_of(spoken: list[dict[str, Screen]]) -> dict[str, Screen]:
    """Return each screen of several languages in the language where it is longest."""
    return {name: max((screens[name] for screens in spoken), key=letters) for name in spoken[0]}


def letters(screen: Screen) -> int:
    """Return how many letters are on a screen; a Chinese character is as wide as two."""
    said = [*screen.status, *(hint.control + hint.action for hint in screen.hints)]
    said += [message.text for message in (screen.instruction, *screen.warnings) if message]
    if menu := screen.menu:
        said += [menu.title, *menu.paragraphs]
        said += [fact.label + fact.value for fact in menu.facts]
        said += [item.label + item.value + item.help for item in menu.items]
    return sum(
        len(text) + sum(east_asian_width(letter) in "FW" for letter in text) for text in said
    )
