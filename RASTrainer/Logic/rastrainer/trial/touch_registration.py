"""The registration of a trial, open or finished, by its touches and its trace: one for all methods.

A trace is matched to the surface of the scenario's head, from where the landmarks put it. Such a
registration is used for its matrix: its residuals belong to the landmarks, which the fit does not
minimize, and its FRE is the root mean square distance of the trace's inliers to the surface.

If the skin had shifted from its place in the images, the points are also put back and registered
again, which shows the effect of the shift.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated, Any

import numpy as np

from rastrainer import protocol, transforms
from rastrainer.errors import InputError
from rastrainer.files.point_list import PointList, pair
from rastrainer.head.mesh import HeadMesh
from rastrainer.head.trial_head import SkinShift
from rastrainer.json_checks import list_of
from rastrainer.json_records import record_from_json
from rastrainer.procedure.record import RegisteredTouch
from rastrainer.registration.fits import RIGID
from rastrainer.registration.localization_error import error_along_surface, isotropic_error
from rastrainer.registration.registration import Registration, register, register_all_kinds
from rastrainer.registration.surface_checks import SurfaceMatch
from rastrainer.registration.surface_error import TraceGuide, knowledge_of, surface_target_error
from rastrainer.registration.surface_match import match_surface
from rastrainer.registration.target_error import TargetError, target_error, true_target_error_mm
from rastrainer.scenario.scenario import Scenario, task_by_method
from rastrainer.trial.record import PlayedMethod, TracePoint, TrialRecord, trace_points
from rastrainer.trial.score_reference import head_of, point_normals
from rastrainer.trial.wording import Sentence, say


@dataclass(frozen=True)
class GivenPoints:
    """The points that register a trial, World, mm; the trace, (n, 3) float, may be empty."""

    task: str
    touches: PointList
    method: protocol.RegistrationMethod = protocol.RegistrationMethod.FIDUCIALS
    trace_mm: np.ndarray = field(default_factory=lambda: np.empty((0, 3)))

    @classmethod
    def of_record(cls, record: TrialRecord) -> GivenPoints:
        touches = PointList(record.labels, record.positions_mm)
        return cls(record.task, touches, record.method, record.trace_mm)

    @classmethod
    def of_answer(
        cls, answer: Mapping[str, Any], least_traced: int = protocol.MIN_TRACE_POINTS
    ) -> GivenPoints:
        """Return the points in an answer to GetTrial about an open trial.

        A trace needs `least_traced` points: enough to register it, or fewer to show it.
        """
        what = "The trial"
        given = record_from_json(_TrialAnswer, answer, what)
        is_by_fiducials = given.method is protocol.RegistrationMethod.FIDUCIALS
        if is_by_fiducials and len(given.touches) < protocol.FIDUCIAL_COUNT:
            raise InputError(
                f"{what}: touches must be a list of {protocol.FIDUCIAL_COUNT} touches."
            )
        trace = given.trace if given.method in protocol.TRACED_METHODS else ()
        if given.method in protocol.TRACED_METHODS and len(trace) < least_traced:
            raise InputError(
                f"{what}: trace must be a list of {least_traced} points or more, not {len(trace)}."
            )
        places = np.array([point.position_mm for point in given.touches])
        touches = PointList(tuple(point.label for point in given.touches), places)
        return cls(given.task, touches, given.method, np.reshape(trace, (-1, 4))[:, :3])


@dataclass(frozen=True)
class _TrialAnswer:
    """What an answer to GetTrial holds of the points of an open trial."""

    task: str
    touches: Annotated[
        tuple[RegisteredTouch, ...],
        list_of(protocol.COARSE_LANDMARKS, protocol.FIDUCIAL_COUNT, "touches"),
    ]
    method: PlayedMethod = protocol.RegistrationMethod.FIDUCIALS
    trace: Annotated[tuple[TracePoint, ...], trace_points] = ()


@dataclass(frozen=True, eq=False)
class FollowedTrace:
    """A trace where the landmarks put it, RAS mm, and where the next points would help most.

    The places are (n, 3) float, the next one (3,) float or None; `away_mm` is as in `TraceGuide`.
    """

    places: np.ndarray
    away_mm: np.ndarray
    next_place: np.ndarray | None


def follow_trace(
    guide: TraceGuide, scenario: Scenario, given: GivenPoints, is_drawing: bool
) -> FollowedTrace:
    """Return the trace so far; `is_drawing` says whether a stroke is being drawn.

    The true pose of the head stays unknown: the landmarks that were touched stand for it.
    """
    task = task_by_method(scenario, given.task, given.method)
    labels, moving, fixed = pair(given.touches, PointList(task.labels, task.fiducials))
    places = transforms.apply(register(moving, fixed, RIGID, labels).matrix, given.trace_mm)
    found = guide.next_place(places, is_drawing)
    return FollowedTrace(places, guide.away_mm, None if found is None else found.position)


def trace_guide(scenario: Scenario, mesh: HeadMesh) -> TraceGuide:
    to_head = transforms.inverse(scenario.head_to_world)
    eye = transforms.apply(to_head, scenario.cameras["close-up"].position_mm)
    return TraceGuide(mesh, scenario.target.position_ras, eye)


LEAST_ALONG_SURFACE = 6
"""Touches; of fewer, the residuals do not separate the error along the skin from that across it."""


@dataclass(frozen=True)
class TouchRegistration:
    """Possible registrations of a trial by kind, their expected errors at the scenario's target,
    and the match of the trace, where the method has one."""

    fits: Mapping[str, Registration]
    target_errors: Mapping[str, TargetError]
    match: SurfaceMatch | None = None

    @property
    def rigid(self) -> Registration:
        return self.fits[RIGID]

    def arguments(self, trial_id: str) -> dict[str, Any]:
        return {
            "trialId": trial_id,
            "matrix": [float(value) for value in self.rigid.matrix.ravel()],
            "freMm": self.rigid.fre_mm,
            "expectedTreMm": self.target_errors[RIGID].expected_mm,
        }


def register_trial(
    given: GivenPoints, scenario: Scenario, pause: Callable[[], None] = lambda: None
) -> TouchRegistration:
    """Register the touches and the trace of a trial by its method.

    The touches are paired by label with the fiducials of the task, or the landmarks. `pause` is
    called between the steps, every 10 ms or so; a worker may wait in it.
    """
    task = task_by_method(scenario, given.task, given.method)
    labels, moving, fixed = pair(given.touches, PointList(task.labels, task.fiducials))
    fits = register_all_kinds(moving, fixed, labels)
    if given.method in protocol.TRACED_METHODS:
        # The rigid one alone: a scaled or sheared head would fit any trace. It has the landmarks'
        # points and the matrix that fits the trace to the surface.
        coarse = fits[RIGID]
        match = match_surface(given.trace_mm, head_of(scenario), coarse.matrix)
        pause()
        error = surface_target_error(knowledge_of(match), scenario.target.position_ras)
        vectors = transforms.apply(match.matrix, coarse.moving_mm) - coarse.fixed_mm
        matched = replace(
            coarse,
            matrix=match.matrix,
            fre_mm=match.rms_mm,
            residual_vectors_mm=vectors,
            residuals_mm=np.linalg.norm(vectors, axis=1),
            warnings=(*coarse.warnings, *match.warnings),
        )
        return TouchRegistration({RIGID: matched}, {RIGID: error}, match)
    normals = normals_at(scenario, given.task, labels, given.method)
    errors = {}
    for kind, fit in fits.items():
        pause()
        is_along = len(labels) >= LEAST_ALONG_SURFACE
        localization = error_along_surface(fit, normals) if is_along else isotropic_error(fit)
        pause()
        errors[kind] = target_error(fit, scenario.target.position_ras, localization)
    pause()
    return TouchRegistration(fits, errors)


def normals_at(
    scenario: Scenario, task_name: str, labels: Sequence[str], method: protocol.RegistrationMethod
) -> np.ndarray:
    """Return the outward normals of the skin at points of a task by a method, (n, 3) float, RAS.

    `labels` name the n points.
    """
    task = task_by_method(scenario, task_name, method)
    rows = [task.labels.index(label) for label in labels]
    return point_normals(scenario, task)[rows]


def unshifted_tre_mm(
    record: TrialRecord, scenario: Scenario, head_to_world: np.ndarray, skin: SkinShift
) -> float | None:
    """Return the true TRE that a trial would have had with the skin as in the images, mm.

    Its touches and its trace are put back to where they would have been measured, and registered
    again. None if the skin was not shifted, or if the points cannot be registered then.
    """
    if skin.is_none:
        return None
    to_head, mesh = transforms.inverse(head_to_world), head_of(scenario)
    given = GivenPoints.of_record(record)

    def put_back(points: np.ndarray) -> np.ndarray:
        in_head = skin.unmeasured(transforms.apply(to_head, points), mesh)
        return transforms.apply(head_to_world, in_head)

    touches = PointList(given.touches.labels, put_back(given.touches.points))
    unshifted = replace(given, touches=touches, trace_mm=put_back(given.trace_mm))
    try:
        matrix = register_trial(unshifted, scenario).rigid.matrix
    except InputError:
        return None
    return true_target_error_mm(matrix, head_to_world, scenario.target.position_ras)


def skin_sentences(
    skin: SkinShift, true_tre_mm: float, unshifted_mm: float | None
) -> tuple[Sentence, ...]:
    """Return the sentences for the trainee after a trial; none if the skin was not shifted."""
    if skin.is_none:
        return ()
    amounts = {"shift": skin.shift_mm, "indentation": skin.indentation_mm, "tre": true_tre_mm}
    if unshifted_mm is None:
        return (say("skin", **amounts),)
    return (say("skin and error", **amounts, without=unshifted_mm),)
