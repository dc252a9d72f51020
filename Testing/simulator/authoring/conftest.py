"""Fixtures for the tests of making scenarios."""

import pytest

from Testing.domain.scenario.made_up_scenario import png


@pytest.fixture
def unrendered(monkeypatch):
    """Write some picture in place of the rendered one; return the heads that it would show."""
    shown = []

    def draw(path, _scenario, head):
        shown.append(head)
        path.write_bytes(png())

    for module in ("export", "make"):
        monkeypatch.setattr(f"rastrainer_simulator.authoring.{module}.draw_preview", draw)
    return shown
