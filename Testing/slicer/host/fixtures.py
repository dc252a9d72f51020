"""Fixtures of the host; a conftest.py imports them."""

import pytest


@pytest.fixture
def host(tmp_path):
    """Slicer with our module in it; a slot that raised fails the test."""
    from Testing.slicer.host.host import Host  # Loads Qt, which few tests need.

    running = Host(tmp_path / "slicer")
    try:
        yield running
    finally:
        running.close()
    assert not running.errors, "\n".join(running.errors)


@pytest.fixture
def module_widget(host):
    """The module's widget, opened and entered."""
    return host.open()
