"""Pip sets the simulator up in a private folder, from known packages only."""

import shutil
import sys
import zipfile
from pathlib import Path

import pytest

from rastrainer import __version__
from rastrainer.errors import InputError
from rastrainer.slicer.program.simulator_package import (
    WHEEL,
    SimulatorPackage,
    pythonSlicer,
)
from rastrainer.slicer.program.simulator_program import ProgramState, SimulatorProgram
from rastrainer.slicer.program.simulator_setup import SimulatorSetup
from Testing.slicer.made_up_package import (
    PackageIndex,
    lock_entry,
    write_package,
    write_wheel,
)
from Testing.slicer.simulator_double import wait_until

CLI = """
import bolt
import sys
def main():
    print("RASTrainer simulator ready on 127.0.0.1:" + sys.argv[sys.argv.index("--port") + 1])
    if "--lan" in sys.argv:
        print("RASTrainer simulator serves views on http://127.0.0.1:18945, pairing code 012345")
        print("RASTrainer simulator serves the local network on https://192.0.2.7:18946 or "
              "https://192.0.2.8:18946; the browser warns of a certificate made here: "
              "compare its SHA-256 fingerprint, AB:01")
        print("RASTrainer simulator has a new pairing code for views: 678901")
    sys.stdout.flush()
    if "--close" in sys.argv:
        return 0
    if "--end" in sys.argv:
        print("The port is taken.")
        return 3
    input_never_comes = __import__("threading").Event()
    input_never_comes.wait()
if __name__ == "__main__":
    sys.exit(main())
"""


def write_module(folder):
    """Write a simulator that only says that it is ready, and needs a bolt; return both."""
    bolt = write_wheel(folder / "wheels", "bolt", "1.0", {"bolt.py": "SIZE = 8\n"})
    elsewhere = lock_entry(bolt, "sys_platform == 'elsewhere'").replace("bolt", "nut")
    return write_package(folder / "module", CLI, [lock_entry(bolt), elsewhere]), bolt


def setup_in(folder, package):
    return SimulatorSetup(Path(sys.executable), folder / "private folder" / "simulator", package)


@pytest.fixture
def module(tmp_path):
    return write_module(tmp_path)


@pytest.fixture
def bolt(module):
    return module[1]


@pytest.fixture
def setup(tmp_path, module):
    return setup_in(tmp_path, module[0])


@pytest.fixture(scope="module")
def once_installed(tmp_path_factory):
    """A folder of wheels, a module and the simulator that was set up, of which tests use copies."""
    folder = tmp_path_factory.mktemp("installed")
    package, bolt = write_module(folder)
    lines, error = run_setup(setup_in(folder, package), wheels=bolt.parent)
    assert error == "", lines
    return folder


@pytest.fixture
def installed(once_installed, tmp_path):
    """The set-up of a simulator that is installed."""
    shutil.copytree(once_installed, tmp_path, dirs_exist_ok=True)
    return setup_in(tmp_path, SimulatorPackage(tmp_path / "module"))


def run_setup(setup, **source):
    lines, ends = [], []
    setup.progressed.connect(lines.append)
    setup.finished.connect(ends.append)
    setup.begin(**source)
    wait_until(lambda: ends, setup.process)
    return lines, ends[0]


def left_beside(setup):
    """Return the names next to the private folder, once the removal has finished."""
    kept = setup.folder.parent
    wait_until(lambda: not any(".removed-" in path.name for path in kept.iterdir()), lambda: None)
    return [path.name for path in kept.iterdir()]


def test_the_simulator_is_set_up_from_a_folder_of_wheels_without_a_network_or_the_users_settings(
    setup, bolt, tmp_path, monkeypatch
):
    settings = tmp_path / "pip.conf"
    settings.write_text("[global]\nno-binary = :all:\nuser = true\n", encoding="utf-8")
    monkeypatch.setenv("PIP_CONFIG_FILE", str(settings))
    monkeypatch.setenv("PIP_TARGET", str(tmp_path / "elsewhere"))
    left = setup.folder.with_name("simulator.removed-0123")
    left.mkdir(parents=True)
    (left / "library.so").touch()
    counts = []
    setup.progressed.connect(lambda _line: counts.append(setup.fetched))
    assert (setup.isCurrent, setup.folder.is_dir(), setup.count) == (False, False, 0)
    with PackageIndex([bolt]) as index:
        monkeypatch.setenv("PIP_INDEX_URL", index.address)
        monkeypatch.setenv("PIP_EXTRA_INDEX_URL", index.address)
        lines, error = run_setup(setup, wheels=bolt.parent)
    assert error == "", lines
    assert index.asked == []
    assert not (tmp_path / "elsewhere").exists()
    assert (setup.installedVersion, setup.isCurrent) == (__version__, True)
    assert (setup.folder / "rastrainer_simulator" / "cli" / "main.py").is_file()
    assert (setup.folder / "bolt.py").is_file()
    assert setup.installedMB == 0
    # Only packages for this platform were counted.
    assert (setup.fetched, setup.count) == (2, 2)
    assert sorted(set(counts)) == [0, 1, 2]
    assert setup.isInstalling
    # What an interrupted removal left behind is gone.
    assert left_beside(setup) == ["simulator"]


def test_nothing_is_built_from_source_during_setup_even_if_its_hash_is_known(setup, bolt, tmp_path):
    mark = tmp_path / "sources were run"
    path = bolt.with_name("bolt-1.0.zip")
    with zipfile.ZipFile(path, "w") as sources:
        sources.writestr("bolt-1.0/setup.py", f"open({str(mark)!r}, 'w').close()")
    write_package(setup.package.folder, CLI, [lock_entry(path)])
    bolt.rename(bolt.with_name("other-1.0-py3-none-any.whl"))
    lines, error = run_setup(setup, wheels=bolt.parent)
    assert "installation ended with status 1" in error
    assert any("No matching distribution found for bolt==1.0" in line for line in lines)
    assert not mark.exists()


def test_only_third_party_packages_are_requested_from_a_private_index(setup, bolt, tmp_path):
    ours = write_wheel(tmp_path / "squatter", "rastrainer", "99.0", {"rastrainer_simulator.py": ""})
    with PackageIndex([bolt, ours]) as index:
        lines, error = run_setup(setup, index=index.address)
        assert error == "", lines
        assert index.asked == ["/simple/bolt/", f"/files/{bolt.name}"]
    assert (setup.folder / "rastrainer_simulator" / "cli" / "main.py").is_file()


def test_whatever_a_setup_cannot_start_with_is_reported(setup, bolt, tmp_path):
    for address in ("file:///tmp", "https://"):
        with pytest.raises(InputError, match="start it with https://"):
            setup.begin(index=address)
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match="no wheels"):
        setup.begin(wheels=tmp_path / "empty")
    missing = SimulatorSetup(tmp_path / "PythonSlicer", tmp_path / "simulator", setup.package)
    with pytest.raises(InputError, match="cannot be started: No such file"):
        missing.begin()
    wheel = setup.package.folder / WHEEL
    wheel.write_bytes(wheel.read_bytes()[:-1])
    with pytest.raises(InputError, match="is damaged: reinstall the extension RASTrainer"):
        setup.begin(wheels=bolt.parent)
    (setup.package.folder / f"{WHEEL}.sha256").unlink()
    with pytest.raises(InputError, match=r"is missing in .*: reinstall the extension"):
        setup.begin(wheels=bolt.parent)
    assert not setup.folder.parent.exists()


def test_a_simulator_that_ends_by_itself_says_why(installed):
    for word, state, sentence in (
        ("--end", ProgramState.FAILED, "(status 3): The port is taken."),
        # As where its window is closed.
        ("--close", ProgramState.STOPPED, "The simulator has ended."),
    ):
        program = SimulatorProgram()
        program.start(installed.command(["simulator", "--port", "1", word]))
        wait_until(lambda program=program: not program.isRunning, program.process)
        assert program.state is state
        assert program.sentence.endswith(sentence)


def test_the_pairing_of_a_headset_is_described_until_the_simulator_ends(installed):
    program, received = SimulatorProgram(), [""]

    def note():
        if received[-1] != program.pairingSentence:
            received.append(program.pairingSentence)

    program.changed.connect(note)
    program.start(installed.command(["simulator", "--port", "18999", "--lan"]))
    assert program.state is ProgramState.STARTING
    wait_until(lambda: program.pairingCode == "678901", program.process)
    assert (program.state, program.port) == (ProgramState.READY, 18999)
    program.stop()
    wait_until(lambda: not program.isRunning, program.process)
    here = "In a browser or a headset open http://127.0.0.1:18945"
    everywhere = f"{here} or https://192.0.2.7:18946 or https://192.0.2.8:18946"
    warning = "The browser warns about a certificate made here; its SHA-256 fingerprint is AB:01."
    assert received[1] == f"{here} and enter the code 012345."
    assert received[-2:] == [f"{everywhere} and enter the code 678901. {warning}", ""]


def test_nothing_is_installed_whose_hash_is_unknown_and_the_old_set_up_stays(installed, tmp_path):
    write_wheel(tmp_path / "wheels", "bolt", "1.0", {"bolt.py": "SIZE = 'whatever'\n"})
    lines, error = run_setup(installed, wheels=tmp_path / "wheels")
    assert "installation ended with status 1" in error
    assert "choose a folder of wheels or your own package index" in error
    assert any("DO NOT MATCH THE HASHES" in line for line in lines)
    assert installed.isCurrent
    assert left_beside(installed) == ["simulator"]
    # Another module's simulator of the same version is not mistaken for this one's.
    write_package(installed.package.folder, f"{CLI}# Mended.\n")
    assert (installed.installedVersion, installed.isCurrent) == (__version__, False)
    installed.remove()
    assert not installed.folder.is_dir()
    assert left_beside(installed) == []


def test_an_installation_that_cannot_be_run_is_not_used(setup, tmp_path, bolt):
    package = write_package(tmp_path / "broken", CLI + ")", [lock_entry(bolt)])
    broken = SimulatorSetup(Path(sys.executable), setup.folder, package)
    lines, error = run_setup(broken, wheels=bolt.parent)
    assert "cannot be run (status 1)" in error
    assert "SyntaxError" in lines[-1]
    assert left_beside(setup) == []


def test_a_setup_can_be_canceled(setup, bolt):
    ends = []
    setup.finished.connect(ends.append)
    setup.begin(wheels=bolt.parent)
    with pytest.raises(InputError, match="already being set up"):
        setup.begin(wheels=bolt.parent)
    with pytest.raises(InputError, match="Cancel the set-up first"):
        setup.remove()
    setup.cancel()
    assert setup.isCanceled
    wait_until(lambda: ends, setup.process)
    assert ends == ["The set-up was canceled."]
    assert not setup.isRunning
    assert left_beside(setup) == []


def test_slicers_python_and_the_checkout_are_found_where_they_are(tmp_path):
    (tmp_path / "bin").mkdir()
    name = "PythonSlicer.exe" if sys.platform == "win32" else "PythonSlicer"
    (tmp_path / "bin" / name).touch()
    assert pythonSlicer(tmp_path) == tmp_path / "bin" / name
    assert SimulatorPackage.of(tmp_path / "RASTrainer").checkout is None
    (tmp_path / "pyproject.toml").touch()
    assert SimulatorPackage.of(tmp_path / "RASTrainer").checkout == tmp_path
