"""The section Set-up in the host: its texts before, during and after, and the removal."""

import pytest

from rastrainer.slicer.program.simulator_package import SimulatorPackage
from Testing.slicer.made_up_package import lock_entry, write_package, write_wheel

CLI = """
import sys
import threading
port = sys.argv[sys.argv.index("--port") + 1]
print(f"RASTrainer simulator ready on 127.0.0.1:{port}", flush=True)
threading.Event().wait()
"""


@pytest.fixture
def setup(host, tmp_path):
    """The set-up of an opened module whose simulator only says that it is ready."""
    setup = host.open().logic.session.simulator.setup
    bolt = write_wheel(tmp_path / "wheels", "bolt", "1.0", {"bolt.py": ""})
    setup.package = write_package(tmp_path / "module", CLI, [lock_entry(bolt)])
    host.find("setupGroupBox").collapsed = False
    host.type("wheelsPathLineEdit", str(tmp_path / "wheels"))
    return setup


def test_source_size_and_folder_are_reported_before_anything_is_downloaded(host, monkeypatch):
    setup = host.open().logic.session.simulator.setup
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.setattr("platform.machine", lambda: "x86_64")
    host.find("setupGroupBox").collapsed = False
    host.type("indexLineEdit", "https://mirror.example/simple")
    text = host.text("setupText")
    download, kept = setup.package.sizesMB()
    assert "comes from the package index https://mirror.example/simple" in text
    assert str(setup.folder) in text
    assert f"About {download} MB will be downloaded, and {kept} MB kept." in text
    host.type("wheelsPathLineEdit", "/media/wheels")
    assert "comes from the folder /media/wheels" in host.text("setupText")


def test_the_simulator_is_set_up_package_by_package_and_removed_when_the_user_confirms(
    host, setup, tmp_path
):
    shown = []
    setup.progressed.connect(
        lambda _line: shown.append(
            (host.find("setupProgressBar").value, host.find("setupProgressBar").maximum)
        )
    )
    with pytest.raises(AssertionError, match="There is nothing to remove"):
        host.press("removeSetupButton")
    host.press("setupButton")
    host.wait_until(lambda: "is set up in" in host.text("setupText"), "it is set up")
    assert {(1, 2), (2, 2), (0, 0)} <= set(shown)
    assert not host.find("setupProgressBar").visible
    assert "Installing collected packages" in host.find("setupLogEdit").plainText
    assert host.find("setupCollapsibleButton").collapsed
    host.press("startSimulatorButton")
    host.find("setupCollapsibleButton").collapsed = False
    for name in ("removeSetupButton", "setupButton"):
        with pytest.raises(AssertionError, match="Stop the simulator first"):
            host.press(name)
    host.press("stopSimulatorButton")
    host.wait_until(lambda: host.find("removeSetupButton").enabled, "the simulator has ended")
    host.answer("Remove the simulator", "No")
    host.press("removeSetupButton")
    assert setup.isCurrent
    host.answer("Remove the simulator", "Yes")
    host.press("removeSetupButton")
    assert not setup.folder.exists()
    assert "press Set up, once" in host.text("setupText")
    assert "not set up yet" in host.text("programText")
    # A module without its simulator has to be installed again.
    setup.package = SimulatorPackage(tmp_path)
    host.press("setupButton")
    assert "reinstall the extension RASTrainer" in host.messages[-1].text
