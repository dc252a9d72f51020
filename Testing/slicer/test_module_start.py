"""The module starts without the connector, and without a main window."""

import pytest

from Testing.slicer.host.host import Host
from Testing.slicer.test_images_in_module import wait_for_images


def test_without_the_connector_the_user_learns_what_to_install_before_any_download(tmp_path):
    host = Host(tmp_path, connector=False)
    try:
        session = host.open().logic.session
        host.process_events()
        first, needs_setup = host.text("nextStepText"), session.simulator.needsSetup
        with pytest.raises(AssertionError, match="nextStepButton is disabled"):
            host.press("nextStepButton")
        is_set_up = session.simulator.setup.isRunning
        host.press("connectButton")
        text = host.text("stateText") + host.text("remedyText")
    finally:
        host.close()
    assert (needs_setup, is_set_up) == (True, False)
    assert first == (
        "The extension SlicerOpenIGTLink is not installed. Install it in the Extensions Manager "
        "and restart Slicer."
    )
    assert "SlicerOpenIGTLink" in text
    assert host.errors == []


def test_without_main_window_and_layout_manager_the_module_works(tmp_path):
    host = Host(tmp_path, window=False)
    try:
        host.open()
        host.leave()
        host.enter()
        host.press("showScenarioButton")
        wait_for_images(host)
        from rastrainer.sections.application import isAnythingVisible

        assert isAnythingVisible(True)
        assert not isAnythingVisible(False, True)
    finally:
        host.close()
    assert host.errors == []
