"""Reports without their charts, which take most of the time, for tests of words and tables."""

from contextlib import contextmanager

import pytest
from markupsafe import Markup

from rastrainer_simulator.report import charts

CHARTS = (
    *("grouped_bars", "distribution", "learning_curves", "paired_lines", "effect_sizes"),
    *("calibration_chart", "reliability_chart", "split_chart"),
)


@contextmanager
def without_charts():
    """Have an empty picture in place of each chart."""
    with pytest.MonkeyPatch.context() as patch:
        for name in CHARTS:
            patch.setattr(charts, name, lambda *_arguments: Markup("<svg></svg>"))
        yield
