"""The simulator is set up by pip in a folder of its own, from wheels alone, or not at all."""

import sys
import zipfile
from pathlib import Path

import pytest

from rastrainer import __version__
from rastrainer.errors import InputError
from rastrainer.slicer.child_process import environmentWith
from rastrainer.slicer.simulator_place import defaultPackage, pythonSlicer
from rastrainer.slicer.simulator_program import ProgramState, SimulatorProgram
from rastrainer.slicer.simulator_setup import SetupSource, SimulatorSetup
from Testing.slicer.simulator_double import wait_until

CLI = """
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
"""


@pytest.fixture
def wheels(tmp_path):
    """A folder with one wheel: a simulator that only says that it is ready."""
    folder = tmp_path / "wheels"
    folder.mkdir()
    info = "rastrainer_simulator-1.0.dist-info"
    files = {
        "rastrainer_simulator/__init__.py": "",
        "rastrainer_simulator/cli.py": CLI,
        f"{info}/METADATA": "Metadata-Version: 2.1\nName: rastrainer-simulator\nVersion: 1.0\n",
        f"{info}/WHEEL": "Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: true\n"
        "Tag: py3-none-any\n",
    }
    with zipfile.ZipFile(folder / "rastrainer_simulator-1.0-py3-none-any.whl", "w") as wheel:
        for name, text in files.items():
            wheel.writestr(name, text)
        record = "".join(f"{name},,\n" for name in [*files, f"{info}/RECORD"])
        wheel.writestr(f"{info}/RECORD", record)
    return folder


@pytest.fixture
def setup(tmp_path):
    return SimulatorSetup(Path(sys.executable), tmp_path / "private folder" / "simulator")


def run_setup(setup, source):
    lines, ends = [], []
    setup.progressed.connect(lines.append)
    setup.finished.connect(ends.append)
    setup.begin(source)
    wait_until(lambda: ends, setup.process, 60.0)
    return lines, ends[0]


def test_the_simulator_is_set_up_from_a_folder_of_wheels_without_network(setup, wheels):
    assert not setup.isCurrent
    lines, error = run_setup(setup, SetupSource("rastrainer-simulator", wheels))
    assert error == ""
    assert any("Installing collected packages" in line for line in lines)
    assert (setup.installedVersion, setup.isCurrent) == (__version__, True)
    assert (setup.folder / "rastrainer_simulator" / "cli.py").is_file()


def test_what_was_set_up_starts_tells_its_port_and_stops(setup, wheels):
    run_setup(setup, SetupSource("rastrainer-simulator", wheels))
    program = SimulatorProgram()
    command = setup.command(["simulator", "--port", "18999"])
    program.start(command, environmentWith(setup.folder))
    assert program.state is ProgramState.STARTING
    wait_until(lambda: program.state is ProgramState.READY, program.process, 20.0)
    assert program.port == 18999
    program.stop()
    assert (program.state, program.isRunning) == (ProgramState.STOPPED, False)


def test_how_a_headset_is_paired_is_told_until_the_simulator_ends(setup, wheels):
    run_setup(setup, SetupSource("rastrainer-simulator", wheels))
    program, told = SimulatorProgram(), []
    program.pairingChanged.connect(lambda: told.append(program.pairingSentence))
    program.start(setup.command(["simulator", "--port", "1", "--lan"]))
    wait_until(lambda: program.pairingCode == "678901", program.process, 20.0)
    program.stop()
    here = "In a browser or a headset open http://127.0.0.1:18945"
    everywhere = f"{here} or https://192.0.2.7:18946 or https://192.0.2.8:18946"
    warning = "The browser warns of a certificate made here; its SHA-256 fingerprint is AB:01."
    assert told == [
        "",
        f"{here} and enter the code 012345.",
        f"{everywhere} and enter the code 012345. {warning}",
        f"{everywhere} and enter the code 678901. {warning}",
        "",
    ]


def test_a_simulator_that_ends_by_itself_says_why(setup, wheels):
    run_setup(setup, SetupSource("rastrainer-simulator", wheels))
    program = SimulatorProgram()
    program.start(setup.command(["simulator", "--port", "1", "--end"]))
    wait_until(lambda: program.state is ProgramState.FAILED, program.process, 20.0)
    assert program.sentence.endswith("(status 3): The port is taken.")


def test_a_simulator_whose_window_is_closed_has_simply_ended(setup, wheels):
    run_setup(setup, SetupSource("rastrainer-simulator", wheels))
    program = SimulatorProgram()
    program.start(setup.command(["simulator", "--port", "1", "--close"]))
    wait_until(lambda: not program.isRunning, program.process, 20.0)
    assert (program.state, program.sentence) == (ProgramState.STOPPED, "The simulator has ended.")


def test_a_set_up_that_fails_leaves_the_old_one_and_says_what_to_do(setup, wheels):
    run_setup(setup, SetupSource("rastrainer-simulator", wheels))
    lines, error = run_setup(setup, SetupSource("no-such-package", wheels))
    assert "choose a folder of wheels" in error
    assert any("no-such-package" in line for line in lines)
    assert setup.isCurrent
    assert [path.name for path in setup.folder.parent.iterdir()] == ["simulator"]


def test_a_set_up_can_be_canceled(setup, wheels):
    ends = []
    setup.finished.connect(ends.append)
    setup.begin(SetupSource("rastrainer-simulator", wheels))
    with pytest.raises(InputError, match="being set up already"):
        setup.begin(SetupSource("rastrainer-simulator", wheels))
    setup.cancel()
    assert ends == ["The set-up was canceled."]
    assert not setup.isRunning
    assert list(setup.folder.parent.iterdir()) == []


def test_a_folder_without_wheels_and_a_python_that_is_not_there_are_told(setup, tmp_path):
    with pytest.raises(InputError, match="no wheels"):
        setup.begin(SetupSource("rastrainer", tmp_path))
    missing = SimulatorSetup(tmp_path / "PythonSlicer", tmp_path / "simulator")
    with pytest.raises(InputError, match="cannot be started: No such file"):
        missing.begin(SetupSource("rastrainer"))


def test_slicers_python_and_the_checkout_are_found_where_they_are(tmp_path):
    (tmp_path / "bin").mkdir()
    name = "PythonSlicer.exe" if sys.platform == "win32" else "PythonSlicer"
    (tmp_path / "bin" / name).touch()
    assert pythonSlicer(tmp_path) == tmp_path / "bin" / name
    assert defaultPackage(tmp_path / "RASTrainer") == f"rastrainer=={__version__}"
    (tmp_path / "pyproject.toml").touch()
    assert defaultPackage(tmp_path / "RASTrainer") == str(tmp_path)
