"""The order of the methods with skin that shifts, and that stored trials are what is played."""

import pytest

from rastrainer.protocol import RegistrationMethod
from Testing.error_rates import drawn_traces
from Testing.error_rates.method_errors import CHUNK, keys, play, stored


def true_mm(method, shift_mm):
    own = [one for one in stored() if (one.method, one.shift_mm) == (method.value, shift_mm)]
    return (sum(one.true2 for one in own) / sum(one.trials for one in own)) ** 0.5


def test_with_skin_that_shifts_screws_beat_markers_and_markers_landmarks_and_surface():
    screws, markers, landmarks, surface = (
        true_mm(method, 2.0)
        for method in (
            RegistrationMethod.BONE_SCREWS,
            RegistrationMethod.FIDUCIALS,
            RegistrationMethod.LANDMARKS,
            RegistrationMethod.SURFACE,
        )
    )
    assert screws < markers < landmarks
    assert markers < surface


def test_each_chunk_is_stored_once_and_is_one_of_those_to_be_played():
    known = [one.key for one in stored()]
    assert len(known) == len(set(known))
    assert set(known) <= {(method.value, shift, chunk) for method, shift, chunk in keys(2000)}
    assert {one.trials for one in stored()} == {CHUNK}


def test_each_drawn_trace_is_stored_once_and_one_is_drawn_and_matched_again():
    known = {one.key: one for one in drawn_traces.stored()}
    assert len(known) == len(drawn_traces.stored())
    assert set(known) <= set(drawn_traces.keys(drawn_traces.SEEDS))
    kept = known["colin27", drawn_traces.STROKES, 200, 0.0, 0]
    again = drawn_traces.play(*kept.key)
    assert again.error_mm == pytest.approx(kept.error_mm, abs=0.05)
    assert again.slide_mm == pytest.approx(kept.slide_mm, rel=0.05)


@pytest.mark.soak
@pytest.mark.parametrize("method", RegistrationMethod)
def test_a_stored_chunk_is_reproduced(method):
    (kept,) = [one for one in stored() if one.key == (method.value, 2.0, 0)]
    again = play(method, 2.0, 0)
    assert abs(again.held - kept.held) <= 1
    assert again.true2 == pytest.approx(kept.true2, rel=0.02)
