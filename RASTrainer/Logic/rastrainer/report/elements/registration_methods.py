"""Which trials a report is about where they were registered by different methods."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

from rastrainer.number_text import counted
from rastrainer.registration.methods import RegistrationMethod
from rastrainer.study.study_data import StudyData


def compared_method(data: StudyData) -> str:
    """Return the method whose trials are compared: fiducials, or the one of most trials."""
    counts = Counter(trial.method for trial in data.trials)
    fiducials = RegistrationMethod.FIDUCIALS.value
    return fiducials if fiducials in counts or not counts else counts.most_common(1)[0][0]


def with_one_method(data: StudyData) -> StudyData:
    """Return the study with the trials of the compared method only."""
    method = compared_method(data)
    return replace(data, trials=tuple(t for t in data.trials if t.method == method))


def methods_note(data: StudyData) -> str:
    """Return which trials `with_one_method` leaves out; "" if none."""
    compared = compared_method(data)
    left_out = Counter(trial.method for trial in data.trials if trial.method != compared)
    if not left_out:
        return ""
    others = " and ".join(
        f"{counted(count, 'trial')} by {method}" for method, count in sorted(left_out.items())
    )
    return (
        f"Trials by different methods of registration have other points, times and residuals: "
        f"but for “Methods of registration”, which compares their errors, this report is about "
        f"those by {compared} and leaves out {others}. trials.csv has all of them, each with its "
        "method."
    )
