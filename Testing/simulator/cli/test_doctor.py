"""`rastrainer doctor` finds missing parts and suggests remedies."""

import json
import socket
import sys
from importlib import metadata
from types import SimpleNamespace

import pytest

from rastrainer_simulator.cli import doctor
from rastrainer_simulator.cli.doctor import OK, PROBLEM, WARNING
from rastrainer_simulator.cli.main import main
from Testing.free_port import free_port
from Testing.sdl_virtual_gamepad import VirtualGamepad


def answers(test, **arguments):
    return list(test(SimpleNamespace(**arguments)))


def verdicts(found):
    return [verdict for verdict, _sentence in found]


@pytest.fixture
def held():
    """Return a port that a program holds."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        yield listener.getsockname()[1]


def test_python_its_packages_and_the_kinematics_are_named(monkeypatch):
    found = answers(doctor.check_python)
    assert set(verdicts(found)) == {OK}
    assert f"numpy {metadata.version('numpy')}" in found[1][1]
    pinocchio = f"Pinocchio {metadata.version('pin')} computes the robot's kinematics."
    assert found[-1] == (OK, pinocchio)
    monkeypatch.setenv("RASTRAINER_KINEMATICS", "numpy")
    numpy = f"numpy {metadata.version('numpy')} computes the robot's kinematics."
    assert answers(doctor.check_python)[-1] == (OK, numpy)
    monkeypatch.setenv("RASTRAINER_KINEMATICS", "guess")
    assert answers(doctor.check_python)[-1][0] == PROBLEM


def test_without_a_display_or_a_browser_the_window_is_reported_as_unavailable(monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    ((verdict, sentence),) = answers(doctor.check_window)
    assert (verdict, "no display" in sentence) == (WARNING, True)
    monkeypatch.setenv("DISPLAY", ":0")
    ((verdict, sentence),) = answers(doctor.check_window)
    assert (verdict, "shows the page in a window" in sentence) == (OK, True)
    monkeypatch.setenv("PATH", "/none")
    ((verdict, sentence),) = answers(doctor.check_window)
    assert (verdict, "no Chrome, Chromium or Edge" in sentence) == (WARNING, True)


def test_a_gamepad_is_named_and_a_missing_one_is_a_warning():
    ((verdict, sentence),) = answers(doctor.check_gamepad)
    assert verdict == WARNING
    assert "No gamepad" in sentence
    gamepad = VirtualGamepad(lambda *_strengths: None)
    gamepad.plug_in()
    try:
        ((verdict, sentence),) = answers(doctor.check_gamepad)
    finally:
        gamepad.unplug()
    assert verdict == OK
    assert "is plugged in" in sentence


@pytest.fixture
def no_slicer(tmp_path, monkeypatch):
    """Return the only folder that is searched for Slicer, which is not there."""
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("SLICER_HOME", raising=False)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setitem(doctor.PLACES, sys.platform, str(tmp_path))
    return tmp_path


def test_slicer_and_its_extension_are_found_or_missed(no_slicer):
    ((verdict, sentence),) = answers(doctor.check_slicer)
    assert verdict == WARNING
    assert "not found" in sentence
    slicer = no_slicer / "Slicer-5.10.0-linux-amd64"
    slicer.mkdir()
    (slicer / "Slicer").touch()
    found, extension = answers(doctor.check_slicer)
    assert found == (OK, f"3D Slicer is in {slicer}.")
    assert extension[0] == WARNING
    assert "SlicerOpenIGTLink is missing" in extension[1]
    (slicer / "slicer.org" / "Extensions-33000" / "SlicerOpenIGTLink").mkdir(parents=True)
    assert verdicts(answers(doctor.check_slicer)) == [OK, OK]
    (no_slicer / "Slicer-5.8.1-linux-amd64").mkdir()
    (no_slicer / "Slicer-5.8.1-linux-amd64" / "Slicer").touch()
    (older,) = (each for each in answers(doctor.check_slicer) if "is older than" in each[1])
    assert older[0] == WARNING


def test_a_folder_is_checked_for_write_permission_and_free_space(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("notes")
    folders = {"records": tmp_path / "a" / "b", "config": tmp_path / "file" / "c"}
    missing, blocked, _logs = answers(doctor.check_disk, **folders)
    assert missing[0] in (OK, WARNING)
    assert not (tmp_path / "a").exists()
    assert blocked[0] == PROBLEM
    assert "cannot be written to" in blocked[1]
    for megabytes, verdict in ((50, PROBLEM), (600, WARNING), (9000, OK)):
        usage = SimpleNamespace(free=megabytes * 10**6)
        monkeypatch.setattr(doctor.shutil, "disk_usage", lambda _path, found=usage: found)
        found = answers(doctor.check_disk, records=tmp_path, config=tmp_path)
        assert set(verdicts(found)) == {verdict}


def test_the_doctor_prints_one_screen_with_remedies_and_exits_with_1_if_there_is_a_problem(
    tmp_path, held, capsys
):
    def words(port):
        ports = ("doctor", "--port", str(port), "--view-port", str(port))
        return (*ports, "--records", str(tmp_path), "--config", str(tmp_path / "config"))

    assert main(words(free_port())) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) <= 24
    assert {line[9:19].strip() for line in lines if line[:8].strip()} == {
        *("python", "window", "browser", "gamepad", "ports", "slicer", "disk")
    }
    assert main([*words(held), "--json"]) == 1
    findings = json.loads(capsys.readouterr().out)
    assert {"check", "verdict", "sentence", "remedy"} == set(findings[0])
    assert PROBLEM in {finding["verdict"] for finding in findings}
    assert all(bool(each["remedy"]) == (each["verdict"] != OK) for each in findings)
