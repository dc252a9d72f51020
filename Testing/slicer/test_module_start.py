"""Whether the module starts: the host refuses the parameters that Slicer refuses."""

import shutil

import pytest

from Testing.slicer.host.host import MODULE_FILE, Host
from Testing.slicer.test_images_in_module import wait_for_images

OPTIONAL_UNION = "Optional[Union[vtkMRMLMarkupsFiducialNode, vtkMRMLMarkupsLineNode]]"


def test_a_parameter_that_slicer_refuses_leaves_the_panel_visible_but_dead(tmp_path):
    folder = tmp_path / "RASTrainer"
    folder.mkdir()
    text = MODULE_FILE.read_text(encoding="utf-8")
    assert OPTIONAL_UNION in text
    (folder / "RASTrainer.py").write_text(
        text.replace(OPTIONAL_UNION, "slicer.vtkMRMLDisplayableNode")
    )
    shutil.copytree(MODULE_FILE.parent / "Resources", folder / "Resources")
    (folder / "Logic").symlink_to(MODULE_FILE.parent / "Logic")
    (tmp_path / "assets").symlink_to(MODULE_FILE.parents[1] / "assets")
    host = Host(tmp_path / "slicer", module_file=folder / "RASTrainer.py")
    try:
        host.made_widget()
        assert "abstract class" in host.errors[0]
        assert host.text("connectButton") == "Connect"
        assert host.widget._timer is None
    finally:
        host.close()


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
