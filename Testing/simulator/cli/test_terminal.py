"""The commands where characters or a home folder are missing, or a file is in the way."""

import io
import subprocess
import sys

import pytest

from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.cli import doctor
from rastrainer_simulator.cli.main import main

ANSWERS = [(doctor.WARNING, "No 汉字 in 10 µm.")]
CHECKS = (("font", lambda _arguments: ANSWERS, "Install one → it works…"),)


@pytest.mark.parametrize("encoding", ["ascii", "utf-8"])
@pytest.mark.parametrize("words", ["scenario build --help", "doctor"])
def test_a_terminal_that_lacks_characters_gets_the_others(monkeypatch, encoding, words):
    monkeypatch.setattr(doctor, "CHECKS", CHECKS)
    written = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(written, encoding=encoding))
    try:
        status = main(words.split())
    except SystemExit as ended:
        status = ended.code
    sys.stdout.flush()
    assert status == 0
    said = written.getvalue().decode(encoding)
    assert "10 " in said or "usage: rastrainer" in said
    assert encoding != "utf-8" or "?" not in said


WITHOUT_HOME = """
import os, sys
os.environ.pop("HOME", None)
os.path.expanduser = lambda path: path
from rastrainer_simulator.cli.main import main
for line in sys.stdin:
    try:
        print("status", main(line.split()), flush=True)
    except SystemExit as ended:
        print("status", ended.code, flush=True)
"""


def test_without_a_home_folder_what_needs_none_works_and_the_rest_says_what_to_do(tmp_path):
    commands = {
        "--version": "0",
        "--help": "0",
        "simulator --help": "0",
        f"scenario list --library {tmp_path}": "0",
        "scenario list": "2",
        "verify": "2",
    }
    ended = subprocess.run(
        [sys.executable, "-c", WITHOUT_HOME],
        input="\n".join(commands),
        capture_output=True,
        text=True,
        check=True,
    )
    lines = ended.stdout.splitlines()
    assert [line.split()[1] for line in lines if line.startswith("status")] == [*commands.values()]
    assert "Traceback" not in ended.stderr
    assert "This user has no home folder: name one in the environment variable HOME" in ended.stderr


VOLUME = asset_path("scenarios", "colin27") / "volume.nrrd"


@pytest.mark.parametrize(
    "words",
    [
        f"scenario plan {VOLUME.parent} -o",
        "simulate-cohort --trainees 2 -o",
    ],
)
def test_a_file_in_the_place_of_an_output_folder_is_reported_and_stays(tmp_path, capsys, words):
    path = tmp_path / "file"
    path.write_text("mine")
    assert main([*words.split(), str(path)]) == 2
    said = capsys.readouterr().err
    assert str(path) in said
    assert said.count("\n") == 1
    assert path.read_text() == "mine"


def test_what_the_system_refuses_is_one_sentence_with_the_name(monkeypatch, tmp_path, capsys):
    def refuse(_arguments):
        (tmp_path / "none" / "file").read_text()

    monkeypatch.setattr(doctor, "CHECKS", (("disk", refuse, ""),))
    assert main(["doctor"]) == 2
    assert capsys.readouterr().err == (
        f"rastrainer: {tmp_path / 'none' / 'file'} cannot be used: no such file or directory.\n"
    )
