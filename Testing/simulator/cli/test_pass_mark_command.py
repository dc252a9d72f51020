"""`rastrainer pass-mark`: the mark of a study's two groups, and where it is written down."""

import shutil
import uuid
from pathlib import Path

import pytest

from rastrainer.study.database.aborted_trials import AbortedTrials
from rastrainer.study.database.study import Study
from rastrainer.study.protocol.study_protocol import read_study_protocol
from rastrainer_simulator.cli.main import main
from Testing.domain.trial.trial_records import first_score, gentle_score, make_aborted, make_record

SHIPPED = Path(__file__).parents[3] / "assets" / "studies" / "published-protocol.json"
NOVICES, EXPERTS = [f"N{n}" for n in range(5)], [f"E{n}" for n in range(5)]


def add(study, trainee, number, time_s, task="task-1", score=gentle_score):
    """Store a trial whose score follows from its time."""
    record = make_record(
        trialId=str(uuid.uuid5(uuid.NAMESPACE_OID, f"{trainee} {number} {task}")),
        trainee=trainee,
        task=task,
        startedUtc=f"2024-05-{number + 1:02d}T09:30:00Z",
    )
    study.add_trial(record, score=score(time_s, 0.4))


@pytest.fixture
def study(tmp_path):
    """A study in which novices need about twice an expert's time, after a first slow trial."""
    path = tmp_path / "study.db"
    with Study.open(path) as study:
        for group, base in ((NOVICES, 260.0), (EXPERTS, 110.0)):
            for place, name in enumerate(group):
                times = [900.0, *(base + 8.0 * place + 3.0 * n for n in range(3))]
                for number, time_s in enumerate(times):
                    add(study, name, number, time_s)
                add(study, name, 9, 5000.0, task="trial-run")
    return path


def words(study, *more, novices=NOVICES, experts=EXPERTS):
    return ["pass-mark", str(study), "--novices", *novices, "--experts", *experts, *more]


def means(path, names):
    with Study.open(path) as study:
        return [sum(t.score for t in study.past_trials(name)[-3:]) / 3 for name in names]


def test_the_mark_lies_between_the_groups_last_trials_without_trial_runs(study, capsys):
    assert main(words(study)) == 0
    told = capsys.readouterr().out
    mark = float(told.split()[2])
    assert max(means(study, NOVICES)) < mark < min(means(study, EXPERTS))
    assert "here it is 0 % and 0 %" in told
    with Study.open(study) as opened:
        assert [trial.task for trial in opened.past_trials("N0")] == ["task-1"] * 4


def test_scores_of_two_versions_give_no_mark(study, capsys):
    with Study.open(study) as opened:
        add(opened, "N3", 20, 270.0, score=first_score)
    assert main(words(study)) == 2
    assert "scores of the versions 1 and 2, which do not compare" in capsys.readouterr().err


def test_a_mark_of_earlier_scores_is_reported_and_is_written_into_no_protocol(
    study, tmp_path, capsys
):
    with Study.open(study) as opened:
        for number in range(20, 23):
            for names, time_s in ((NOVICES, 260.0), (EXPERTS, 110.0)):
                for place, name in enumerate(names):
                    add(opened, name, number, time_s + 5.0 * place, score=first_score)
    assert main(words(study)) == 0
    assert "of 100 (score version 1)" in capsys.readouterr().out
    protocol = tmp_path / "next.json"
    shutil.copy(SHIPPED, protocol)
    assert main(words(study, "--write", str(protocol))) == 2
    assert "score version 1, and trials get scores of version 2 now" in capsys.readouterr().err
    assert protocol.read_bytes() == SHIPPED.read_bytes()


def test_the_mark_is_written_into_the_protocol_of_the_next_study(study, tmp_path, capsys):
    protocol = tmp_path / "next.json"
    shutil.copy(SHIPPED, protocol)
    before = read_study_protocol(protocol)
    assert main(words(study, "--write", str(protocol))) == 0
    mark = float(capsys.readouterr().out.split()[2])
    after = read_study_protocol(protocol)
    assert after.pass_mark == round(mark)
    assert (after.tasks, after.questionnaires) == (before.tasks, before.questionnaires)


@pytest.mark.parametrize(
    ("more", "sentence"),
    [
        ({"novices": NOVICES[:4]}, "at least 5 novices"),
        ({"experts": [*EXPERTS[:4], "N0"]}, "N0 is named in both groups"),
        ({"experts": [*EXPERTS[:4], "new"]}, "new has 0 scored trials, and 3 are needed"),
        ({"experts": [*EXPERTS[:4], "nobody"]}, "nobody"),
        ({"novices": EXPERTS, "experts": NOVICES}, "experts who score higher"),
    ],
)
def test_groups_that_give_no_mark_are_refused_and_nothing_is_written(
    study, tmp_path, capsys, more, sentence
):
    protocol = tmp_path / "next.json"
    shutil.copy(SHIPPED, protocol)
    with Study.open(study) as opened:
        opened.create_trainee("new")
    assert main(words(study, "--write", str(protocol), **more)) == 2
    assert sentence in capsys.readouterr().err
    assert protocol.read_bytes() == SHIPPED.read_bytes()


def test_aborted_trials_of_the_groups_are_reported_since_they_have_no_score(study, capsys):
    before = means(study, NOVICES)
    with Study.open(study) as opened:
        for number, name in enumerate((NOVICES[0], NOVICES[0], EXPERTS[1])):
            AbortedTrials(opened).add(make_aborted(900 + number, trainee=name))
    assert main(words(study)) == 0
    assert "They aborted 3 trials after a touch" in capsys.readouterr().out
    assert means(study, NOVICES) == before
