"""`rastrainer doctor` finds what is missing and says what to do."""

import json
import os
import socket
import sys
from datetime import datetime, timezone
from importlib import metadata
from pathlib import Path

import pytest

from rastrainer_simulator.cli.doctor import software, system
from rastrainer_simulator.cli.doctor.check_result import CheckStatus
from rastrainer_simulator.cli.doctor.graphics import check_font, check_gamepad, check_graphics
from rastrainer_simulator.cli.doctor.software import check_python, check_slicer
from rastrainer_simulator.cli.doctor.system import (
    check_clock,
    check_folders,
    check_journals,
    check_ports,
    check_real_time,
    check_settings,
)
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.ops.system_paths import chinese_font
from rastrainer_simulator.record.trial_archive import SUFFIX
from Testing.end_to_end.virtual_display import VirtualDisplay
from Testing.free_port import free_port
from Testing.sdl_virtual_gamepad import VirtualGamepad

NOW = datetime(2026, 3, 1, tzinfo=timezone.utc)


def verdicts(findings):
    return [finding.verdict for finding in findings]


@pytest.fixture
def held():
    """Return a port that a program holds."""
    with socket.create_server(("127.0.0.1", 0)) as listener:
        yield listener.getsockname()[1]


def test_a_free_port_is_ok_and_one_in_use_is_reported_with_the_program_that_holds_it(held):
    port = free_port()
    assert verdicts(check_ports(port, port)) == [CheckStatus.OK, CheckStatus.OK]
    link, views = check_ports(held, held)
    assert (link.verdict, views.verdict) == (CheckStatus.PROBLEM, CheckStatus.WARNING)
    for finding in (link, views):
        assert f"Port {held}" in finding.sentence
        assert f"(process {os.getpid()}) holds it" in finding.sentence
        assert finding.remedy


def test_python_and_its_packages_are_found():
    found = list(check_python())
    assert CheckStatus.PROBLEM not in verdicts(found)
    assert "numpy" in found[-1].sentence


def test_the_kinematics_backend_is_named(monkeypatch):
    def kinematics_result():
        (finding,) = (each for each in check_python() if each.check == "kinematics")
        return finding.verdict, finding.sentence

    pinocchio = f"Pinocchio {metadata.version('pin')} computes the robot's kinematics."
    assert kinematics_result() == (CheckStatus.OK, pinocchio)
    monkeypatch.setenv("RASTRAINER_KINEMATICS", "numpy")
    assert kinematics_result() == (
        CheckStatus.OK,
        f"numpy {metadata.version('numpy')} computes the robot's kinematics.",
    )
    monkeypatch.setenv("RASTRAINER_KINEMATICS", "guess")
    assert kinematics_result()[0] is CheckStatus.PROBLEM


def test_a_missing_package_is_a_problem_with_the_command_that_fixes_it(monkeypatch):
    monkeypatch.setitem(software.MODULES, "no-such-package", "no_such_module")
    (finding,) = (each for each in check_python() if each.verdict is CheckStatus.PROBLEM)
    assert "no-such-package cannot be loaded" in finding.sentence
    assert "pip install" in finding.remedy


def test_without_a_display_the_window_is_reported_as_unavailable(monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    (finding,) = check_graphics()
    assert finding.verdict is CheckStatus.WARNING
    assert "no display" in finding.sentence


def test_on_a_display_the_renderer_of_opengl_is_named(monkeypatch):
    with VirtualDisplay() as display:
        monkeypatch.setenv("DISPLAY", display.name)
        (finding,) = check_graphics()
    assert "OpenGL works" in finding.sentence
    if "llvmpipe" in finding.sentence:
        assert finding.verdict is CheckStatus.WARNING
        assert "driver" in finding.remedy


@pytest.mark.parametrize(
    ("answer", "verdict", "words"),
    [
        ("renderer: NVIDIA T4", CheckStatus.OK, "OpenGL works: NVIDIA T4."),
        ("software renderer: SWR", CheckStatus.WARNING, "the processor draws: SWR."),
    ],
)
def test_only_a_renderer_in_software_is_a_warning(monkeypatch, answer, verdict, words):
    monkeypatch.setenv("DISPLAY", ":0")
    (finding,) = check_graphics((sys.executable, "-c", f"print({answer!r})"))
    assert finding.verdict is verdict
    assert words in finding.sentence


@pytest.mark.parametrize(
    ("script", "words"),
    [
        ("import os; os.abort()", "ended with -6"),
        ("import sys; sys.exit('No window can be opened.')", "No window can be opened."),
        ("print('renderer')", "OpenGL does not work"),
    ],
)
def test_an_opengl_that_crashes_its_process_is_reported(monkeypatch, script, words):
    monkeypatch.setenv("DISPLAY", ":0")
    (finding,) = check_graphics((sys.executable, "-c", script))
    assert finding.verdict is CheckStatus.WARNING
    assert words in finding.sentence
    assert finding.remedy


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere a font is always there")
def test_a_chinese_font_is_named_and_a_missing_one_reported_with_a_remedy(monkeypatch, tmp_path):
    try:
        (finding,) = check_font()
        assert (finding.verdict, finding.remedy) == (CheckStatus.OK, "")
        for path in (Path(os.devnull).parent, without_chinese(tmp_path)):
            monkeypatch.setenv("PATH", str(path))
            chinese_font.cache_clear()
            (finding,) = check_font()
            assert finding.verdict is CheckStatus.WARNING
            assert "the window cannot show Chinese" in finding.sentence
            assert "fonts-wqy-microhei" in finding.remedy
    finally:
        chinese_font.cache_clear()


def without_chinese(folder):
    """Return a folder with fontconfig on a computer that has fonts for other languages alone."""
    program = folder / "fc-match"
    program.write_text(f"#!/bin/sh\necho '{__file__}'\necho 'de|en|th'\n")
    program.chmod(0o755)
    return folder


def test_a_gamepad_is_named_and_a_missing_one_is_a_warning(tmp_path):
    (finding,) = check_gamepad(tmp_path)
    assert finding.verdict is CheckStatus.WARNING
    assert "No gamepad" in finding.sentence
    gamepad = VirtualGamepad(lambda *_strengths: None)
    gamepad.plug_in()
    try:
        (finding,) = check_gamepad(tmp_path)
    finally:
        gamepad.unplug()
    assert finding.verdict is CheckStatus.OK
    assert "is plugged in" in finding.sentence


def test_slicer_and_its_extension_are_found_or_the_user_learns_where_to_get_them(
    tmp_path, monkeypatch
):
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("SLICER_HOME", raising=False)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    (missing,) = check_slicer((tmp_path,))
    assert missing.verdict is CheckStatus.WARNING
    assert "download.slicer.org" in missing.remedy
    slicer = tmp_path / "Slicer-5.10.0-linux-amd64"
    slicer.mkdir()
    (slicer / "Slicer").touch()
    found, extension = check_slicer((tmp_path,))
    assert str(slicer) in found.sentence
    assert extension.verdict is CheckStatus.WARNING
    assert "Extensions Manager" in extension.remedy
    (slicer / "slicer.org" / "Extensions-33000" / "SlicerOpenIGTLink").mkdir(parents=True)
    assert verdicts(check_slicer((tmp_path,))) == [CheckStatus.OK, CheckStatus.OK]


def test_a_slicer_older_than_5_10_is_reported(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("SLICER_HOME", raising=False)
    for name in ("Slicer-5.8.1-linux-amd64", "Slicer-5.10.0-linux-amd64", "Slicer"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "Slicer").touch()
    (old,) = (each for each in check_slicer((tmp_path,)) if "is older than" in each.sentence)
    assert old.verdict is CheckStatus.WARNING
    assert "Slicer-5.8.1" in old.sentence
    assert "5.10 or newer" in old.remedy


def test_real_time_priority_is_tried_without_a_lasting_effect(monkeypatch):
    before = os.sched_getscheduler(0)
    (finding,) = check_real_time()
    assert finding.verdict in (CheckStatus.OK, CheckStatus.WARNING)
    assert os.sched_getscheduler(0) == before

    def refuse(*_arguments):
        raise PermissionError

    monkeypatch.setattr(os, "sched_setscheduler", refuse)
    (finding,) = check_real_time()
    assert finding.verdict is CheckStatus.WARNING
    assert "limits.conf" in finding.remedy


def test_a_folder_is_checked_for_write_permission_and_free_space(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("notes")
    missing, blocked = check_folders(
        {"trials": tmp_path / "a" / "b", "settings": tmp_path / "file" / "c"}
    )
    assert missing.verdict in (CheckStatus.OK, CheckStatus.WARNING)
    assert not (tmp_path / "a").exists()
    assert blocked.verdict is CheckStatus.PROBLEM
    assert "cannot be written to" in blocked.sentence
    for megabytes, verdict in (
        (50, CheckStatus.PROBLEM),
        (600, CheckStatus.WARNING),
        (9000, CheckStatus.OK),
    ):
        usage = lambda _path, free=megabytes: type("Usage", (), {"free": free * 10**6})  # noqa: E731
        monkeypatch.setattr(system.shutil, "disk_usage", usage)
        (finding,) = check_folders({"trials": tmp_path})
        assert finding.verdict is verdict


def test_a_clock_that_was_set_back_is_detected_from_the_journals(tmp_path):
    assert verdicts(check_clock(tmp_path, NOW)) == [CheckStatus.OK]
    (tmp_path / f"20260501T120000Z_x{SUFFIX}").touch()
    (finding,) = check_clock(tmp_path, NOW)
    assert finding.verdict is CheckStatus.WARNING
    assert "was set back" in finding.sentence
    (finding,) = check_clock(tmp_path / "none", datetime(1970, 1, 1, tzinfo=timezone.utc))
    assert "cannot be 1970" in finding.sentence


def test_settings_are_read_as_the_simulator_reads_them(tmp_path):
    assert list(check_settings(tmp_path)) == []
    (tmp_path / "limits.json").write_text('{"views": {"views": 0}}')
    (tmp_path / "preferences.json").write_text("{")
    (tmp_path / "controls.json").write_text("[]")
    limits, preferences, controls = check_settings(tmp_path)
    assert limits.verdict is CheckStatus.PROBLEM
    assert "views.views must be a whole number above 0" in limits.sentence
    assert "preferences.json" in preferences.sentence
    assert "controls.json" in controls.sentence
    assert (preferences.verdict, controls.verdict) == (CheckStatus.WARNING, CheckStatus.WARNING)


def test_an_unusable_journal_is_named(tmp_path):
    (finding,) = check_journals(tmp_path)
    assert finding.verdict is CheckStatus.OK
    assert "0 trials wait" in finding.sentence
    (tmp_path / f"20260301T000000Z_x{SUFFIX}").write_text("notes")
    (finding,) = check_journals(tmp_path)
    assert finding.verdict is CheckStatus.WARNING
    assert f"20260301T000000Z_x{SUFFIX} is not a trial's journal" in finding.sentence
    assert "rastrainer verify" in finding.remedy


def test_a_page_that_was_not_built_is_reported(monkeypatch, tmp_path):
    monkeypatch.setattr(software, "page_folder", lambda: tmp_path)
    assert verdicts(software.check_page()) == [CheckStatus.OK]
    monkeypatch.setattr(software, "page_folder", lambda: None)
    (finding,) = software.check_page()
    assert finding.verdict is CheckStatus.WARNING
    assert "make page" in finding.remedy


def words(folder: Path, port: int):
    return [
        *("doctor", "--port", str(port), "--view-port", str(port)),
        *("--records", str(folder), "--config", str(folder / "config")),
    ]


def test_the_doctor_prints_one_line_per_check_and_exits_with_1_if_there_is_a_problem(
    tmp_path, held, capsys
):
    assert main(words(tmp_path, free_port())) == 0
    lines = capsys.readouterr().out.splitlines()
    checks = {line[9:19].strip() for line in lines if line[:8].strip()}
    assert checks == {
        *("python", "packages", "kinematics", "graphics", "font", "gamepad", "ports"),
        *("page", "slicer", "real time", "folders", "journals", "clock"),
    }
    assert main([*words(tmp_path, held), "--json"]) == 1
    findings = json.loads(capsys.readouterr().out)
    assert {"check", "verdict", "sentence", "remedy"} == set(findings[0])
    assert "problem" in {finding["verdict"] for finding in findings}
