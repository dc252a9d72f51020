"""What has to come before a task, in one sentence."""

from __future__ import annotations

from rastrainer.protocol import TRIAL_RUN, StepKind, TutorialRule
from rastrainer_simulator.flow.session.session import TrainingSession


def obstacle(session: TrainingSession, task: str) -> str:
    """Return why the trainee cannot begin a task; "" where nothing is in the way."""
    unready = _unready(session)
    if unready:
        return unready
    say = session.texts.say
    trainee = session.trainee.strip()
    step = session.study.step_of(trainee)
    if step is not None:
        is_asked = step.is_played and (step.task, step.mode) == (task, session.mode)
        if not is_asked:
            return say("experiment.study", step=session.step_sentence(step))
    elif session.preferences.order == "any":
        return ""
    if task == TRIAL_RUN and needs_tutorial(session):
        return say("experiment.tutorial first")
    if step is not None:
        return ""
    scenario = session.scenario
    order = [each.name for each in scenario.tasks]
    missing = session.progress.missing_before(trainee, scenario.name, task, order)
    if not missing:
        return ""
    key = "experiment.trial run first" if missing == TRIAL_RUN else "experiment.order"
    return say(key, task=session.task_title(missing))


def tutorial_obstacle(session: TrainingSession) -> str:
    """Return why the trainee cannot begin the tutorial; "" where nothing is in the way.

    In a study it is practice, and comes where the study has it: before a trial run, once.
    """
    unready = _unready(session)
    if unready:
        return unready
    say = session.texts.say
    trainee = session.trainee.strip()
    step = session.study.step_of(trainee)
    if step is None:
        return ""
    is_asked = step.kind == StepKind.TRIAL_RUN and step.mode == session.mode
    has_done = session.tutorials.has_done(trainee, session.operator.learned)
    if is_asked and not has_done:
        return ""
    return say("experiment.study", step=session.step_sentence(step))


def _unready(session: TrainingSession) -> str:
    """Return why nothing can begin yet; "" where trainee and robot are ready."""
    if not session.trainee.strip():
        return session.texts.say("experiment.no trainee")
    return session.texts.say("experiment.being set up") if session.is_being_set_up else ""


def tutorial_rule(session: TrainingSession) -> TutorialRule:
    """Return whether the tutorial comes before the trial run: by the study, or by the setting."""
    step = session.study.step_of(session.trainee.strip())
    chosen = step.tutorial if step is not None and step.tutorial else session.preferences.tutorial
    return TutorialRule(chosen)


def needs_tutorial(session: TrainingSession) -> bool:
    """Return whether the trial run waits for the tutorial with the device in use."""
    if tutorial_rule(session) is not TutorialRule.REQUIRED:
        return False
    return not session.tutorials.has_done(session.trainee.strip(), session.operator.learned)
