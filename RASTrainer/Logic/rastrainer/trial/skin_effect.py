"""What a shift of the skin did to a trial: its true error beside that without the shift."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.files.point_list import PointList
from rastrainer.head.skin_shift import SkinShift
from rastrainer.registration.target_error import true_errors
from rastrainer.scenario.scenario import Scenario
from rastrainer.trial.given_points import GivenPoints
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.touch_registration import head_of, register_trial
from rastrainer.trial.wording import Sentence, say


def unshifted_tre_mm(
    record: TrialRecord, scenario: Scenario, head_to_world: np.ndarray, skin: SkinShift
) -> float | None:
    """Return the true TRE that a trial would have had with the skin as in the images, mm.

    Its touches and its trace are put back to where they would have been measured, and registered
    again.

    Args:
        record: The trial.
        scenario: In which it was played.
        head_to_world: (4, 4) float, mm, the true pose.
        skin: How the skin lay, with its seed.

    Returns:
        None where the skin lay as in the images, or where the points cannot be registered so.
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
    return float(np.linalg.norm(true_errors(matrix, head_to_world, scenario.target_position)))


def skin_sentence(
    skin: SkinShift, true_tre_mm: float, unshifted_mm: float | None
) -> Sentence | None:
    """Return what the trainee reads after a trial; None where the skin lay as in the images."""
    if skin.is_none:
        return None
    amounts = {"shift": skin.rms_mm, "indentation": skin.indentation_mm, "tre": true_tre_mm}
    if unshifted_mm is None:
        return say("skin", **amounts)
    return say("skin and error", **amounts, without=unshifted_mm)
