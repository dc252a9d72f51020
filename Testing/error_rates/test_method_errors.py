"""The order of the methods with skin that shifts, and that the kept rows can be played again."""

from dataclasses import astuple

import pytest

from rastrainer.protocol import RegistrationMethod
from Testing.error_rates import drawn_traces
from Testing.error_rates.method_errors import FILE, Chunk, play
from Testing.error_rates.row_files import stored_rows

CHUNKS = stored_rows(FILE, Chunk)


def true_mm(method, shift_mm):
    own = [one for one in CHUNKS if (one.method, one.shift_mm) == (method.value, shift_mm)]
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


def test_a_kept_trace_is_drawn_and_matched_again():
    rows = stored_rows(drawn_traces.FILE, drawn_traces.Drawn)
    known = {astuple(one)[:5]: one for one in rows}
    key = ("colin27", drawn_traces.STROKES, 100, 0.0, 0)
    again = drawn_traces.play(*key)
    assert again.error_mm == pytest.approx(known[key].error_mm, abs=0.05)
    assert again.expected_mm == pytest.approx(known[key].expected_mm, rel=0.05)
    assert again.holds == known[key].holds
    assert again.slide_mm == pytest.approx(known[key].slide_mm, rel=0.05)


@pytest.mark.soak
@pytest.mark.parametrize("method", RegistrationMethod)
def test_a_kept_chunk_is_reproduced(method):
    (kept,) = [one for one in CHUNKS if astuple(one)[:3] == (method.value, 2.0, 0)]
    again = play(method.value, 2.0, 0)
    assert abs(again.held - kept.held) <= 1
    assert again.true2 == pytest.approx(kept.true2, rel=0.02)
