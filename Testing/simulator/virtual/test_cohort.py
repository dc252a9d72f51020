"""A simulated cohort is a study like any other, repeatable, and its truth can be recovered."""

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.protocol import FIDUCIAL_COUNT
from rastrainer.study.database.study import Study
from rastrainer.study.study_data import read_study_data
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.report.report import report_html
from rastrainer_simulator.virtual.cohort import DATABASE, simulate_cohort
from rastrainer_simulator.virtual.play import PlaySettings
from Testing.simulator.report.without_charts import without_charts
from Testing.simulator.virtual.conftest import AIM_FACTOR, BRISK


@pytest.fixture(scope="module")
def data(played):
    return read_study_data(played / DATABASE)


def test_the_cohort_is_stored_like_a_real_study_and_reported(data, played):
    assert (data.trainees, data.modes) == (("V0001", "V0002"), ("desktop", "hmd"))
    values = data.trials[0].values
    for name in ("score", "expected_tre_mm", "true_tre_mm", "sparc", "path_efficiency"):
        assert np.isfinite(values[name])
    assert 0.2 < values["path_efficiency"] < 1.0
    with Study.open(played / DATABASE) as study:
        modes = [[t.record.mode for t in study.history(f"V000{i}")] for i in (1, 2)]
    assert modes == [["desktop", "hmd"], ["hmd", "desktop"]]
    with without_charts():
        page = report_html(data)
    assert "2 trainees did 4 trials" in page
    assert "without a trial run" in page
    assert "(virtual trainees)" in page


def test_the_scatter_of_the_aim_is_recovered_from_the_registrations(data):
    """FRE² estimates FLE²; a tip that stops within 0.4 mm of its aim adds a little."""
    fle_of = {}
    for mode, factor in (("desktop", 1.0), ("hmd", AIM_FACTOR)):
        squares = [t.values["rmse_mm"] ** 2 for t in data.of_mode(mode)]
        fle_of[mode] = np.sqrt(np.mean(squares) / (1 - 2 / FIDUCIAL_COUNT))
        aimed = np.sqrt(2) * factor * BRISK.aim_sd_mm
        assert fle_of[mode] == pytest.approx(aimed, rel=0.3)
    assert fle_of["hmd"] > 1.5 * fle_of["desktop"]


def test_a_folder_that_is_not_empty_is_left_alone(protocol, population, tmp_path):
    (tmp_path / "thesis.txt").write_text("mine")
    with pytest.raises(InputError, match="is not empty"):
        simulate_cohort(protocol, population, 2, 0, tmp_path, PlaySettings(), workers=1)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.txt"]


def test_the_command_reports_power_without_playing(capsys):
    words = ["simulate-cohort", "--trainees", "12", "--power", "50", "--hmd-aim", "1.3"]
    assert main(words) == 0
    text = capsys.readouterr().out
    assert "50 studies of 12 trainees" in text
    assert "not played" in text
    lines = [line.split()[0] for line in text.splitlines()[4:]]
    assert lines == ["completion_time_s", "rmse_mm", "score"]


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--trainees", "1"], "--trainees: must be a whole number from 2 to 100000"),
        (["--trainees", "5"], "Name the folder of the study with -o."),
        (["-o", "x", "--aim", "50"], "--aim: must be a number from 0.0 to 3.0"),
        (["--power", "20", "--hmd-aim", "0"], "factors from 0.1 to 10"),
        (["-o", "x", "--protocol", "missing.json"], "missing.json"),
    ],
)
def test_bad_arguments_give_a_one_sentence_error(words, sentence, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["simulate-cohort", *words]) == 2
    printed = capsys.readouterr().err
    assert sentence in printed
    assert printed.count("\n") == 1
