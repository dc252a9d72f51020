"""The commands for files, as a user runs them."""

import csv
import json
import re
import shutil
import uuid
from pathlib import Path

import numpy as np
import pytest

from rastrainer import protocol, transforms
from rastrainer.errors import InputError
from rastrainer.files.point_files import write_markups
from rastrainer.files.point_list import PointList
from rastrainer.protocol import Mode, RegistrationMethod
from rastrainer.registration.fits import KINDS, RIGID
from rastrainer.registration.registration import register
from rastrainer.study.database.study import Study
from rastrainer.study.protocol.study_protocol import StudyProtocol
from rastrainer.study.ratings import FORMS
from rastrainer_simulator.cli.export import FORMATS
from rastrainer_simulator.cli.main import main, read_commands, run_command
from Testing.domain.trial.trial_records import gentle_score, make_record, make_traced

STUDY = Path(__file__).parents[3] / "assets" / "studies" / "published.csv"


def run(*words):
    return run_command([str(word) for word in words])


@pytest.fixture
def run_json(capsys):
    def run_and_decode(*words):
        assert run(*words, "--json") == 0
        return json.loads(capsys.readouterr().out, parse_constant=pytest.fail)

    return run_and_decode


def write_csv(path, points, labels=None):
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["x", "y", "z"] if labels is None else ["label", "x", "y", "z"])
        for row, point in enumerate(points):
            writer.writerow(
                [*([] if labels is None else [labels[row]]), *map(repr, point.tolist())]
            )
    return path


@pytest.fixture
def files(touched_head, tmp_path):
    moving, fixed, _ = touched_head(0)
    labels = [str(i + 1) for i in range(15)]
    write_markups(tmp_path / "fixed.mrk.json", PointList(tuple(labels), fixed))
    write_csv(tmp_path / "moving.csv", moving[::-1], labels[::-1])
    return moving, fixed, tmp_path / "moving.csv", tmp_path / "fixed.mrk.json"


@pytest.mark.parametrize("kind", ["rigid", "similarity", "affine"])
def test_register_pairs_by_label_and_prints_the_registration_as_json(kind, files, run_json):
    moving, fixed, moving_file, fixed_file = files
    result = run_json("register", moving_file, fixed_file, "--type", kind)
    expected = register(moving, fixed, kind)
    assert result["type"] == kind
    assert result["fre_mm"] == pytest.approx(expected.fre_mm, abs=1e-9)
    np.testing.assert_allclose(result["matrix"], expected.matrix, atol=1e-9)
    assert result["labels"] == [str(i) for i in range(15, 0, -1)]
    np.testing.assert_allclose(result["residuals_mm"], expected.residuals_mm[::-1], atol=1e-9)
    mapped = transforms.apply(np.array(result["matrix"]), moving[::-1])
    np.testing.assert_allclose(result["residual_vectors_mm"], mapped - fixed[::-1], atol=1e-9)
    assert result["warnings"] == []
    low, high = result["expected_tre"]["interval_mm"]
    assert low < result["expected_tre"]["expected_mm"] < high


def test_register_leaves_out_what_is_deselected_in_slicer_and_says_so(files, run_json, capsys):
    moving, fixed, moving_file, fixed_file = files
    content = json.loads(fixed_file.read_bytes())
    point = content["markups"][0]["controlPoints"][4]
    point["position"], point["selected"] = [500.0, 0.0, 0.0], False
    fixed_file.write_text(json.dumps(content))
    result = run_json("register", moving_file, fixed_file)
    kept = [row for row in range(15) if row != 4]
    assert result["labels"] == [str(row + 1) for row in reversed(kept)]
    assert result["fre_mm"] == pytest.approx(register(moving[kept], fixed[kept]).fre_mm)
    assert result["left_out"] == {str(fixed_file): ["5"]}
    run("register", moving_file, fixed_file)
    said = capsys.readouterr().out
    assert f"Left out of {fixed_file}, deselected or not placed in Slicer: 5" in said


def test_register_reports_warnings_in_json_and_as_text(files, tmp_path, run_json, capsys):
    moving, _, _, fixed_file = files
    moving[[2, 8]] = moving[[8, 2]]
    swapped = write_csv(tmp_path / "swapped.csv", moving)
    (warning,) = run_json("register", swapped, fixed_file)["warnings"]
    assert (warning["code"], warning["points"]) == ("order", ["3", "9"])
    assert run("register", swapped, fixed_file) == 0
    assert f"Warning: {warning['message']}" in capsys.readouterr().out


def test_score_reproduces_the_published_tables(run_json, capsys):
    result = run_json("score", STUDY)
    assert list(result) == ["hmd", "desktop"]
    assert round(result["hmd"]["overall"], 2) == 64.82
    assert round(result["desktop"]["overall"], 2) == 67.29
    assert round(result["hmd"]["tasks"]["4"], 2) == 37.10
    assert round(result["desktop"]["subjects"]["1"], 2) == 81.72
    assert round(result["hmd"]["sd_population"], 2) == 25.47
    assert round(result["desktop"]["sd_sample"], 2) == 25.96
    assert round(result["hmd"]["pearson_r"], 3) == 0.963
    assert round(result["desktop"]["equation_3_overall"], 1) == 33.6
    assert run("score", STUDY) == 0
    assert re.search(r"^Task 4 +37\.10$", capsys.readouterr().out, re.MULTILINE)


def test_the_documentation_lists_every_command_as_its_help_does():
    page = (Path(__file__).parents[3] / "docs/how-to/use-the-command-line.md").read_text("utf-8")
    rows = [f"| `{name}` | {command.help} |" for name, command in read_commands().items()]
    assert "\n".join(rows) in page


def test_values_in_the_list_of_commands_are_those_of_the_product():
    lines = {name: command.arguments for name, command in read_commands().items()}
    for command, start in (
        ("register", f"--type {{{','.join(KINDS)}}} = {RIGID}  "),
        ("export", f"--format {{{','.join(FORMATS)}}} *  "),
        ("export", f"--mode {{{','.join(Mode)}}}  "),
        ("export", f"--method {{{','.join(RegistrationMethod)}}} = "),
        ("rate", f"--form {{{','.join(FORMS)}}} *  "),
        ("simulator", f"--host HOST = {protocol.DEFAULT_HOST}  "),
        ("simulator", f"--port PORT(0..65535) = {protocol.DEFAULT_PORT}  "),
    ):
        assert any(line.startswith(start) for line in lines[command]), (command, start)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["register", ".", "missing.csv"], "is a folder"),
        (["register", STUDY, STUDY], "with the header label,x,y,z"),
        (["score", STUDY, "--mean-ct", "vr=120"], "names the mode 'vr', but .* hmd, desktop"),
        (["score", STUDY, "--mean-ct", "hmd=nan"], "mean completion time must be"),
        (["score", STUDY, "--mean-ct", "soon"], "must be a number of seconds or MODE=SECONDS"),
    ],
)
def test_bad_input_is_reported_in_one_sentence(words, sentence):
    with pytest.raises(InputError, match=sentence) as caught:
        run(*words)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("name", "content"), [("bad.mrk.json", b"\xff\xfe"), ("bad.csv", b"label,x,y,z\n1,nan,2,3\n")]
)
def test_bad_files_give_status_2_and_one_line(content, name, tmp_path, capsys):
    path = tmp_path / name
    path.write_bytes(content)
    for words in (["register", str(path), str(path)], ["score", str(path)]):
        assert main(words) == 2
        printed = capsys.readouterr()
        assert printed.out == ""
        assert printed.err.count("\n") == 1
        assert str(path) in printed.err


SHIPPED = Path(__file__).parents[3] / "assets" / "studies" / "published-protocol.json"
NOVICES, EXPERTS = [f"N{n}" for n in range(5)], [f"E{n}" for n in range(5)]


def add(study, trainee, number, time_s, task="task-1", make=make_record):
    """Store a trial whose score follows from its time."""
    record = make(
        trialId=str(uuid.uuid5(uuid.NAMESPACE_OID, f"{trainee} {number} {task}")),
        trainee=trainee,
        task=task,
        startedUtc=f"2024-05-{number + 1:02d}T09:30:00Z",
    )
    study.add_trial(record, score=gentle_score(time_s, 0.4))


@pytest.fixture(scope="module")
def played(tmp_path_factory):
    """A study in which novices need about twice an expert's time, after a first slow trial."""
    path = tmp_path_factory.mktemp("played") / "study.db"
    with Study.open(path) as study, study.database.writing():
        for group, base in ((NOVICES, 260.0), (EXPERTS, 110.0)):
            for place, name in enumerate(group):
                times = [900.0, *(base + 8.0 * place + 3.0 * n for n in range(3))]
                for number, time_s in enumerate(times):
                    add(study, name, number, time_s)
                add(study, name, 9, 5000.0, task="trial-run")
    return path


@pytest.fixture
def study(played, tmp_path):
    return shutil.copy(played, tmp_path / "study.db")


def words(study, *more, novices=NOVICES, experts=EXPERTS):
    return ["pass-mark", str(study), "--novices", *novices, "--experts", *experts, *more]


def means(path, names):
    with Study.open(path) as study:
        scored = [[t.score for t in study.attempts(name) if not t.is_aborted] for name in names]
    return [sum(scores[-3:]) / 3 for scores in scored]


def test_the_pass_mark_lies_between_the_groups_last_trials_without_trial_runs(study, capsys):
    assert main(words(study)) == 0
    output = capsys.readouterr().out
    mark = float(output.split()[2])
    assert max(means(study, NOVICES)) < mark < min(means(study, EXPERTS))
    assert "here it is 0 % and 0 %" in output
    with Study.open(study) as opened:
        assert [trial.task for trial in opened.attempts("N0")] == ["task-1"] * 4


def test_trials_by_two_methods_give_no_pass_mark(study, capsys):
    with Study.open(study) as opened:
        add(opened, "N3", 20, 270.0, make=make_traced)
    assert main(words(study)) == 2
    assert "registered by fiducials and surface, whose scores cannot" in capsys.readouterr().err


def test_a_pass_mark_of_another_method_is_reported_and_not_written_into_a_protocol(
    study, tmp_path, capsys
):
    with Study.open(study) as opened:
        for number in range(20, 23):
            for names, time_s in ((NOVICES, 260.0), (EXPERTS, 110.0)):
                for place, name in enumerate(names):
                    add(opened, name, number, time_s + 5.0 * place, make=make_traced)
    assert main(words(study)) == 0
    assert "of 100 (trials by surface)" in capsys.readouterr().out
    protocol = tmp_path / "next.json"
    shutil.copy(SHIPPED, protocol)
    assert main(words(study, "--write", str(protocol))) == 2
    assert "trials registered by surface, and a protocol's is for" in capsys.readouterr().err
    assert protocol.read_bytes() == SHIPPED.read_bytes()


def test_the_pass_mark_is_written_into_the_protocol_of_the_next_study(study, tmp_path, capsys):
    protocol = tmp_path / "next.json"
    shutil.copy(SHIPPED, protocol)
    before = StudyProtocol.read(protocol)
    assert main(words(study, "--write", str(protocol))) == 0
    mark = float(capsys.readouterr().out.split()[2])
    after = StudyProtocol.read(protocol)
    assert after.pass_mark == round(mark)
    assert (after.tasks, after.questionnaires) == (before.tasks, before.questionnaires)


@pytest.mark.parametrize(
    ("more", "sentence"),
    [
        ({"novices": NOVICES[:4]}, "at least 5 novices"),
        ({"experts": [*EXPERTS[:4], "new"]}, "new has 0 scored trials, and 3 are needed"),
        ({"novices": EXPERTS, "experts": NOVICES}, "experts who score higher"),
        ({"experts": [*EXPERTS[:4], "N0"]}, "N0 is named in both groups"),
    ],
)
def test_groups_that_give_no_pass_mark_are_refused_and_nothing_is_written(
    study, tmp_path, capsys, more, sentence
):
    protocol = tmp_path / "next.json"
    shutil.copy(SHIPPED, protocol)
    with Study.open(study) as opened:
        opened.create_trainee("new")
    assert main(words(study, "--write", str(protocol), **more)) == 2
    assert sentence in capsys.readouterr().err
    assert protocol.read_bytes() == SHIPPED.read_bytes()


CURRICULUM = SHIPPED.with_name("example-curriculum.json")


def test_a_curriculum_is_set_for_one_or_all_and_the_table_shows_their_progress(study, capsys):
    assert main(["curriculum", str(study)]) == 0
    assert capsys.readouterr().out == "No trainee follows a curriculum.\n"
    assert main(["curriculum", str(study), "--set", str(CURRICULUM)]) == 0
    output = capsys.readouterr().out
    assert output.startswith("Everybody follows “First steps” from now on.\n\nE0, First steps: ")
    assert output.count("First steps: ") == 10
    assert main(["curriculum", str(study), "--trainee", "N0"]) == 0
    title, _header, *rows = capsys.readouterr().out.strip().splitlines()
    assert title.startswith("N0, First steps: 0 of 6 reached. Next: Task 1, the weakest open one")
    assert re.split(" {2,}", rows[0])[2:4] == ["0 of 2", "2 trials in a row at 70 or more"]
    assert re.split(" {2,}", rows[1])[2] == "locked"
    assert main(["curriculum", str(study), "--end", "--trainee", "N0"]) == 0
    assert capsys.readouterr().out == "N0 follows no curriculum from now on.\n"
    assert main(["curriculum", str(study), "--trainee", "N0"]) == 0
    assert capsys.readouterr().out == "N0 does not follow a curriculum.\n"
    assert main(["curriculum", str(study), "--trainee", "N9"]) == 2
    assert "no trainee" in capsys.readouterr().err
