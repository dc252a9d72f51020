"""What a trial is like: as the study asks for it, or else as the trainee has chosen."""

from __future__ import annotations

import numpy as np

from rastrainer.protocol import TRIAL_RUN, CommandName, GhostRule, Guidance, RegistrationMethod
from rastrainer.scenario.scenario import method_of, playable_methods
from rastrainer_simulator.flow.session.preferences import faded_guidance
from rastrainer_simulator.flow.session.session import TrainingSession


def start_task(session: TrainingSession, task: str) -> None:
    """Have a trial of a task begun by the trainee, in the chosen mode."""
    trainee = session.trainee.strip()
    start = {"task": task, "trainee": trainee, "mode": session.mode}
    method = registration_method(session, task).value
    chosen = {"procedure": procedure_of(session, task), "method": method}
    step = session.study.step_of(trainee)
    skin = {"skin": dict(step.skin)} if step is not None and step.skin else {}
    session.do(CommandName.START_TASK, {**start, **chosen, **skin})


def procedure_of(session: TrainingSession, task: str) -> str:
    """Return the name of the procedure that follows the touches of a task; "" for none.

    A study says which; else it is the one that the trainee has chosen. The trial run has none.
    """
    step = session.study.step_of(session.trainee.strip())
    if step is not None:
        return step.procedure
    names = [each.name for each in session.scenario.procedures]
    return session.procedure if session.procedure in names and task != TRIAL_RUN else ""


def registration_method(session: TrainingSession, task: str) -> RegistrationMethod:
    """Return by what a trial of a task is registered.

    A study says which; else it is what the trainee has chosen, if the head allows that. In the
    trial run it is fiducials.
    """
    step = session.study.step_of(session.trainee.strip())
    if step is not None:
        return method_of(step.method)
    return offered_method(session) if task != TRIAL_RUN else RegistrationMethod.FIDUCIALS


def offered_method(session: TrainingSession) -> RegistrationMethod:
    """Return the chosen method; fiducials where the head does not allow it."""
    is_offered = session.method in playable_methods(session.scenario)
    return session.method if is_offered else RegistrationMethod.FIDUCIALS


def guidance_of(session: TrainingSession) -> Guidance:
    """Return how the trainee is guided in the present trial, by the study or the setting."""
    training, step = session.training, session.study.step_of(session.training.trainee)
    choice = step.guidance if step is not None and step.guidance else session.preferences.guidance
    order = [task.name for task in session.scenario.tasks]
    return faded_guidance(choice, training.task, order)


def begin_ghost(session: TrainingSession, head_to_world: np.ndarray) -> None:
    """Begin to load the ghost of the present trial; in a study only where its protocol has one.

    HeadToWorld is that of the trial, (4, 4) float, mm.
    """
    training, step = session.training, session.study.step_of(session.training.trainee)
    choice = session.preferences.ghost if step is None else step.ghost
    # Trial runs are not scored: there is no best one. Elsewhere, a ghost would lead to points.
    is_none = not choice or training.task == TRIAL_RUN or not training.is_marked
    rule = GhostRule.OFF if is_none else GhostRule(choice)
    who = training.trainee if rule is GhostRule.OWN else session.preferences.expert
    journals = () if rule is GhostRule.OFF else session.history.best(who, training.task)
    session.ghost.begin(rule, journals, training.trial_id, session.setup, head_to_world)
