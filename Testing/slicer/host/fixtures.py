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


@pytest.fixture(scope="module")
def lasting_host(tmp_path_factory):
    """A host that runs for all tests of a file, with our module open."""
    from Testing.slicer.host.host import Host

    running = Host(tmp_path_factory.mktemp("slicer"))
    try:
        running.open()
        yield running
    finally:
        running.close()


@pytest.fixture
def fresh_module(lasting_host, tmp_path):
    """The open module with an empty scene and a new study."""
    lasting_host.begin_anew(tmp_path / "study.db")
    yield lasting_host
    lasting_host.widget.logic.session.link.disconnect()
    assert not lasting_host.errors, "\n".join(lasting_host.errors)


@pytest.fixture
def module_widget(host):
    """The module's widget, opened and entered."""
    return host.open()


@pytest.fixture
def start_slicer(tmp_path):
    """Returns a function that closes the former Slicer, starts another, and opens sections."""
    from Testing.slicer.host.host import Host

    running = []

    def start(*sections):
        if running:
            running.pop().close()
        running.append(Host(tmp_path / "slicer"))
        running[0].open()
        for section in sections:
            running[0].find(f"{section}CollapsibleButton").collapsed = False
        running[0].process_events()
        return running[0]

    yield start
    errors = list(running[0].errors)
    running.pop().close()
    assert not errors, "\n".join(errors)
