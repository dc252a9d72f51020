"""Whether the module starts: the host refuses the parameters that Slicer refuses."""

import shutil

import pytest

from Testing.slicer.host.host import MODULE_FILE, Host

OPTIONAL_UNION = "Optional[Union[vtkMRMLMarkupsFiducialNode, vtkMRMLMarkupsLineNode]]"


@pytest.fixture
def host_with(tmp_path):
    """Returns a function that opens the module with `plan` annotated differently."""
    hosts = []

    def open_module(annotation):
        folder = tmp_path / "RASTrainer"
        folder.mkdir()
        text = MODULE_FILE.read_text(encoding="utf-8")
        assert OPTIONAL_UNION in text
        (folder / "RASTrainer.py").write_text(text.replace(OPTIONAL_UNION, annotation))
        shutil.copytree(MODULE_FILE.parent / "Resources", folder / "Resources")
        (folder / "Logic").symlink_to(MODULE_FILE.parent / "Logic")
        (tmp_path / "assets").symlink_to(MODULE_FILE.parents[1] / "assets")
        hosts.append(Host(tmp_path / "slicer", module_file=folder / "RASTrainer.py"))
        return hosts[0]

    yield open_module
    for host in hosts:
        host.close()


@pytest.mark.parametrize(
    ("annotation", "reason"),
    [
        ("slicer.vtkMRMLMarkupsNode", "abstract class"),
        ("slicer.vtkMRMLDisplayableNode", "abstract class"),
        ("Union[vtkMRMLMarkupsFiducialNode, vtkMRMLMarkupsLineNode]", "Unable to write value"),
    ],
)
def test_a_parameter_that_slicer_refuses_leaves_the_panel_visible_but_dead(
    host_with, annotation, reason
):
    host = host_with(annotation)
    host.made_widget()
    assert reason in host.errors[0]
    assert host.text("connectButton") == "Connect"
    assert host.widget._timer is None


def test_the_unmodified_module_starts_its_timer(host_with):
    host = host_with(OPTIONAL_UNION)
    widget = host.open()
    assert (host.errors, widget._timer.isActive()) == ([], True)


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


def test_without_main_window_and_layout_manager_the_module_opens(tmp_path):
    host = Host(tmp_path, window=False)
    try:
        host.open()
        host.leave()
        host.enter()
    finally:
        host.close()
    assert host.errors == []
