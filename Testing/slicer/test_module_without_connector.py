"""The module where the extension SlicerOpenIGTLink is not installed."""

import pytest

from Testing.slicer.host.host import Host


@pytest.fixture
def host(tmp_path):
    running = Host(tmp_path, connector=False)
    yield running
    running.close()
    assert running.errors == []


def test_connecting_says_what_to_install(host):
    host.open()
    host.press("connectButton")
    told = host.text("stateText") + host.text("remedyText")
    assert "SlicerOpenIGTLink" in told
