"""A trial as the study requires or the trainee has chosen it, and the reasons against it."""

from __future__ import annotations

import numpy as np

from rastrainer.commands import CommandName
from rastrainer.protocol import (
    DECIDE,
    TRIAL_RUN,
    AssignmentState,
    GhostRule,
    Guidance,
    RegistrationMethod,
    StepKind,
    TutorialRule,
)
from rastrainer.scenario.scenario import method_of, playable_methods
from rastrainer.study_messages import AssignmentStanding, StudyStep
from rastrainer_simulator.flow.session.session import TrainingSession

FIRST_ID = "trainee-1"
"""An ID is a pseudonym that files keep: it is the same in every language."""
_ARROW_TASKS = 2
"""How many tasks after the trial run have an arrow, where guidance fades."""


def start_task(session: TrainingSession, task: str) -> None:
    start: dict[str, object] = {
        "task": task,
        "trainee": session.trainee_id,
        "mode": session.mode,
        "procedure": procedure_of(session, task),
        "method": registration_method(session, task).value,
    }
    if session.step is not None and session.step.skin:
        start["skin"] = dict(session.step.skin)
    session.do(CommandName.START_TASK, start)


def procedure_of(session: TrainingSession, task: str) -> str:
    step = session.step
    if step is not None:
        return step.procedure
    names = [each.name for each in session.scenario.procedures]
    return session.procedure if session.procedure in names and task != TRIAL_RUN else ""


def registration_method(session: TrainingSession, task: str) -> RegistrationMethod:
    step = session.step
    if step is not None:
        return method_of(step.method)
    return offered_method(session) if task != TRIAL_RUN else RegistrationMethod.FIDUCIALS


def offered_method(session: TrainingSession) -> RegistrationMethod:
    """Return the chosen method; fiducials where the head does not allow it."""
    is_offered = session.method in playable_methods(session.scenario)
    return session.method if is_offered else RegistrationMethod.FIDUCIALS


def guidance_of(session: TrainingSession) -> Guidance:
    """Return how the trainee is guided in the present trial, by the study or the setting."""
    training, step = session.training, session.trial_step
    choice = step.guidance if step is not None and step.guidance else session.preferences.guidance
    if choice != Guidance.FADING:
        return Guidance(choice)
    if training.task == TRIAL_RUN:
        return Guidance.WORDS
    tasks = [task.name for task in session.scenario.tasks if task.name != TRIAL_RUN]
    return Guidance.ARROW if training.task in tasks[:_ARROW_TASKS] else Guidance.NONE


def begin_ghost(session: TrainingSession, head_to_world: np.ndarray) -> None:
    """Begin to load the ghost of the present trial; in a study only if its protocol has one.

    HeadToWorld of the trial is (4, 4) float, mm.
    """
    training, step = session.training, session.trial_step
    choice = session.preferences.ghost if step is None else step.ghost
    # Trial runs are not scored: there is no best one. Elsewhere, a ghost would lead to points.
    is_none = not choice or training.task == TRIAL_RUN or not training.is_marked
    rule = GhostRule.OFF if is_none else GhostRule(choice)
    who = training.trainee if rule is GhostRule.OWN else session.preferences.expert
    journals = () if rule is GhostRule.OFF else session.history.best(who, training.task)
    session.ghost.begin(
        rule, journals, training.trial_id, session.control_loop.setup, head_to_world
    )


def obstacle(session: TrainingSession, task: str) -> str:
    """Return why the trainee cannot start a task; "" if nothing prevents it."""
    step, curriculum = session.step, session.curriculum
    if unready := _unready(session):
        return unready
    if step is not None:
        is_asked = step.is_played and (step.task, step.mode) == (task, session.mode)
        return _tutorial_first(session, task) if is_asked else _not_now(session, step)
    if curriculum is None:
        return _missing_before(session, task, is_assigned=False)
    method, procedure = registration_method(session, task).value, procedure_of(session, task)
    played_as = (session.scenario.name, task, session.mode, method, procedure)
    own = [each for each in curriculum.assignments if each.is_played_as(*played_as)]
    if own and all(each.state is AssignmentState.LOCKED for each in own):
        return session.assignment_texts.gate(curriculum, own[0])
    return _missing_before(session, task, is_assigned=bool(own))


def drill_obstacle(session: TrainingSession) -> str:
    """Return why the trainee cannot begin or continue a drill; "" if nothing prevents it."""
    curriculum, unready = session.curriculum, _unready(session)
    if unready or session.step is not None:
        return unready or obstacle(session, DECIDE)
    drills = () if curriculum is None else curriculum.assignments
    own = [each for each in drills if each.task == DECIDE]
    return "" if curriculum is None or not own else assignment_obstacle(session, own[0])


def _not_now(session: TrainingSession, step: StudyStep) -> str:
    return session.say("experiment.study", step=session.step_sentence(step))


def assignment_obstacle(session: TrainingSession, each: AssignmentStanding) -> str:
    """Return why the trainee cannot start a trial of an assignment; "" if nothing prevents it."""
    unready, curriculum = _unready(session), session.curriculum
    if unready or curriculum is None:
        return unready
    if each.state is AssignmentState.LOCKED:
        return session.assignment_texts.gate(curriculum, each)
    scenario = session.scenario
    is_on_head = (
        each.scenario in ("", scenario.name)
        and each.task in {DECIDE, *(task.name for task in scenario.tasks)}
        and each.procedure in {"", *(procedure.name for procedure in scenario.procedures)}
        and (not each.method or each.method in {m.value for m in playable_methods(scenario)})
    )
    if not is_on_head:
        return session.say("assignments.other head")
    return "" if each.task == DECIDE else _missing_before(session, each.task, is_assigned=True)


def _missing_before(session: TrainingSession, task: str, is_assigned: bool) -> str:
    """Return the task to do first, outside of a study; assignments have their own gates."""
    if session.preferences.order == "any":
        return ""
    if task == TRIAL_RUN:
        return _tutorial_first(session, task)
    scenario = session.scenario
    order = [
        each.name for each in scenario.tasks if not is_assigned or each.name in (TRIAL_RUN, task)
    ]
    missing = session.history.missing_before(session.trainee_id, scenario.name, task, order)
    if not missing:
        return ""
    key = "experiment.trial run first" if missing == TRIAL_RUN else "experiment.order"
    return session.say(key, task=session.task_title(missing))


def _tutorial_first(session: TrainingSession, task: str) -> str:
    is_missing = task == TRIAL_RUN and needs_tutorial(session)
    return session.say("experiment.tutorial first") if is_missing else ""


def tutorial_obstacle(session: TrainingSession) -> str:
    """Return why the trainee cannot start the tutorial; "" if nothing prevents it.

    In a study it is practice, and comes where the study has it: before a trial run, once.
    """
    step, unready = session.step, _unready(session)
    if unready or step is None:
        return unready
    is_asked = step.kind == StepKind.TRIAL_RUN and step.mode == session.mode
    return "" if is_asked and not has_learned(session) else _not_now(session, step)


def _unready(session: TrainingSession) -> str:
    if not session.trainee_id:
        return session.say("experiment.no trainee")
    return session.say("being set up") if session.reload.is_under_way else ""


def tutorial_rule(session: TrainingSession) -> TutorialRule:
    step = session.step
    chosen = step.tutorial if step is not None and step.tutorial else session.preferences.tutorial
    return TutorialRule(chosen)


def may_skip(session: TrainingSession) -> bool:
    is_led = session.step is not None or session.curriculum is not None
    return not is_led and not session.lock.is_locked


def skippable(session: TrainingSession) -> str:
    """Return which of "tutorial" and "trial run" comes next and may be skipped; "" for neither."""
    trainee, head = session.trainee_id, session.scenario.name
    order = [task.name for task in session.scenario.tasks]
    if _unready(session) or not may_skip(session) or session.preferences.order == "any":
        return ""
    if session.history.missing_before(trainee, head, order[-1], order) != TRIAL_RUN:
        return ""
    return "tutorial" if needs_tutorial(session) else "trial run"


def usual_id(session: TrainingSession) -> str:
    """Return the ID of who trains here alone: the only one so far, or one to begin with.

    It is "" where several train, and where an instructor gives each an ID.
    """
    if session.services.is_slicer_connected() or session.lock.has_pin:
        return ""
    known = session.history.latest_trainees[:2]
    return FIRST_ID if not known else known[0] if len(known) == 1 else ""


def needs_tutorial(session: TrainingSession) -> bool:
    """Return whether the trial run waits for the tutorial with the device in use."""
    is_skipped = may_skip(session) and (session.trainee_id, "") in session.history.skipped
    if is_skipped or tutorial_rule(session) is not TutorialRule.REQUIRED:
        return False
    return not has_learned(session)


def has_learned(session: TrainingSession) -> bool:
    device = session.operator.learned(session.mode)
    return session.history.has_learned(session.trainee_id, device)
