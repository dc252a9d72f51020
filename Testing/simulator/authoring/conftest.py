"""Fixtures for the tests of making scenarios."""

import pytest

from Testing.domain.scenario.made_up_scenario import png


@pytest.fixture
def unrendered(monkeypatch):
    """Write some picture in place of the rendered one, where that proves nothing."""
    for module in ("export", "make"):
        monkeypatch.setattr(
            f"rastrainer_simulator.authoring.{module}.draw_preview",
            lambda path, _scenario, _head: path.write_bytes(png()),
        )
