"""Trials registered by every method, and a trace registered to a head, as a user runs them."""

import csv
import json

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.files.ply import write_ply
from rastrainer.files.point_files import write_markups
from rastrainer.files.point_list import PointList
from rastrainer.head.mesh import read_head_mesh
from rastrainer.scenario.scenario import load_scenario
from rastrainer.study.database.study import Study
from rastrainer.trial.analysis import RevealedTruth
from rastrainer_simulator.cli.main import main
from Testing.domain.trial.trial_records import make_record
from Testing.simulator.landmarked import LANDMARKS, OVER_THE_FACE, on_skin, write_landmarked


@pytest.fixture(scope="module")
def landmarked(tmp_path_factory):
    return write_landmarked(tmp_path_factory.mktemp("head") / "landmarked")


@pytest.fixture(scope="module")
def traced(landmarked):
    """Landmarks and trace of a trial, in World, and the true pose World→RAS."""
    scenario = load_scenario(landmarked)
    head, pose = read_head_mesh(scenario.head), scenario.perturbed_head_to_world(3)
    trace = np.concatenate([on_skin(head, corners, 3.0) for corners in OVER_THE_FACE])
    fixed = np.array([landmark.position_ras for landmark in LANDMARKS])
    missed = fixed + np.random.default_rng(2).normal(0.0, 1.5, fixed.shape)
    moving = transforms.apply(pose, missed)
    return moving, fixed, transforms.apply(pose, trace), pose


@pytest.fixture
def files(traced, tmp_path):
    moving, fixed, trace, _ = traced
    labels = tuple(landmark.name for landmark in LANDMARKS)
    for name, points in (("moving", moving), ("fixed", fixed)):
        write_markups(tmp_path / f"{name}.mrk.json", PointList(labels, points))
    write_ply(tmp_path / "trace.ply", trace, "World")
    return tmp_path


def matched(files, landmarked, *words):
    return main(
        [
            *("register", str(files / "moving.mrk.json"), str(files / "fixed.mrk.json")),
            *("--surface", str(files / "trace.ply"), "--head", str(landmarked / "head.ply")),
            *words,
        ]
    )


def test_a_scenario_is_compared_by_every_method_with_text_csv_json_and_a_picture(
    landmarked, tmp_path, capsys
):
    words = ["--trials", "1", "--skin-shift", "2", "--seed", "4", "-o", str(tmp_path / "out")]
    assert main(["compare-methods", "--scenario", str(landmarked), *words, "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    names = ["bone-screws", "fiducials", "landmarks", "surface", "landmarks-surface", "scan"]
    assert list(content["methods"]) == names
    rows = list(csv.DictReader((tmp_path / "out" / "methods.csv").open()))
    assert [row["method"] for row in rows] == names
    assert {row["trial"] for row in rows} == {"4"}
    for row in rows:
        assert float(row["interval_low_mm"]) < float(row["expected_tre_mm"])
        assert float(row["true_tre_mm"]) > 0.0
    drawn = (tmp_path / "out" / "methods.svg").read_text()
    assert all(name in drawn for name in names)
    text = (tmp_path / "out" / "methods.txt").read_text()
    assert "skin shift 2 mm RMS" in text
    assert "they do not show which is better" in text


def test_a_study_is_registered_by_every_method_that_its_trials_allow(
    landmarked, traced, tmp_path, capsys
):
    moving, _, trace, pose = traced
    points = [
        {
            "label": landmark.name,
            "positionMm": place,
            "simTimeS": 5.0 + time,
            "utc": "2024-05-17T09:30:00Z",
        }
        for time, (landmark, place) in enumerate(zip(LANDMARKS, moving.tolist(), strict=True))
    ]
    drawn = [[*place, 20.0] for place in trace.tolist()]
    record = make_record(points=points, method="landmarks-surface", trace=drawn)
    with Study.open(tmp_path / "study.db") as study:
        study.add_trial(record)
        study.add_results(record["trialId"], truth=RevealedTruth(tuple(pose.ravel().tolist()), 1.0))
    words = ["compare-methods", str(tmp_path / "study.db"), "--scenario", str(landmarked)]
    assert main([*words, "--json"]) == 0
    methods = json.loads(capsys.readouterr().out)["methods"]
    assert list(methods) == ["landmarks", "surface", "landmarks-surface"]
    assert methods["landmarks-surface"]["true_tre_mm"] < 0.2 < methods["landmarks"]["true_tre_mm"]
    assert methods["surface"]["expected_tre_mm"] < methods["landmarks"]["expected_tre_mm"]


def test_an_unusable_option_is_refused_with_a_message(landmarked, capsys):
    words = ["compare-methods", "--scenario", str(landmarked), "--skin-shift", "30"]
    assert main(words) == 2
    assert "skin shift must be 0 to 20 mm" in capsys.readouterr().err


def test_a_traced_surface_is_registered(files, landmarked, traced, capsys):
    assert matched(files, landmarked, "--json") == 0
    content = json.loads(capsys.readouterr().out)
    off = transforms.apply(np.array(content["matrix"]) @ traced[3], np.zeros(3))
    assert np.linalg.norm(off) < 0.2
    assert content["rms_mm"] < 0.05
    low, high = content["expected_tre"]["interval_mm"]
    assert low < content["expected_tre"]["expected_mm"] < high
