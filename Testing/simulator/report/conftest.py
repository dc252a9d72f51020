"""Fixtures for the tests of the report."""

import pytest

from Testing.simulator.report.without_charts import without_charts


@pytest.fixture
def undrawn():
    """Leave out the charts, which take most of the time, if a test reads only words and tables."""
    with without_charts():
        yield
