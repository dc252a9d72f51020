"""A deleted trainee leaves no trace in the database, the journals, or exports made afterward."""

import pytest

from rastrainer.errors import InputError
from rastrainer.journal.folder import journals
from rastrainer.journal.journal_file import read_journal
from rastrainer.study.database.study import Study
from rastrainer.study.study_data import read_study_data
from rastrainer.study.trainee_data import erase_trainee
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.flow.session.trainee_history import TraineeHistory
from rastrainer_simulator.record.journal_writer import Journal
from rastrainer_simulator.record.trial_context import TutorialOutcome
from rastrainer_simulator.report.report import report_html
from rastrainer_simulator.virtual.cohort import DATABASE, RECORDS
from Testing.simulator.report.without_charts import without_charts


def bytes_below(folder):
    return b"".join(path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file())


def test_no_byte_of_the_trainees_data_is_left(copied, tmp_path, capsys):
    with Study.open(copied / DATABASE) as study:
        ids = [trial.record.trial_id.encode() for trial in study.history("V0002")]
    for name in ("V0001", "V0002"):
        learned = TutorialOutcome(
            trainee=name,
            device="keyboard",
            mode="desktop",
            duration_s=112.0,
            first_error_mm=2.3,
            errors_mm=(1.2, 0.8, 0.6),
        )
        TraineeHistory(copied / RECORDS).keep_tutorial(learned)
    assert all(word in bytes_below(copied) for word in (b"V0002", *ids))
    words = ["delete-trainee", copied / DATABASE, "V0002", "--records", copied / RECORDS]
    assert main([str(word) for word in words]) == 2
    assert "V0002 has 2 trials" in capsys.readouterr().err
    assert main([str(word) for word in (*words, "--yes")]) == 0
    assert "2 trials and 2 journals deleted" in capsys.readouterr().out
    out = tmp_path / "export"
    words = ["export", copied / DATABASE, "-o", out, "--records", copied / RECORDS]
    assert main([str(word) for word in words]) == 0
    with without_charts():
        page = report_html(read_study_data(copied / DATABASE)).encode()
    left = bytes_below(copied) + bytes_below(out) + page
    for word in (b"V0002", *ids):
        assert word not in left
    assert b"V0001" in left
    again = TraineeHistory(copied / RECORDS)
    assert (again.learned.get("V0001") is None, again.learned.get("V0002")) == (False, None)
    assert len(journals(copied / RECORDS)) == 2


def test_damaged_and_unfinished_journals_are_deleted_by_their_trial_or_named(copied, capsys):
    folder = copied / RECORDS
    own, unfinished = (p for p in journals(folder) if read_journal(p).header.trainee == "V0001")
    unknown = folder / "20260101T000000Z_00000000-0000-0000-0000-000000000000.journal"
    unknown.write_bytes(own.read_bytes().replace(b'{"n":1', b"\0\0\0\0\0\0", 1))
    own.write_bytes(b"\0" * 200)
    unfinished.write_bytes(unfinished.read_bytes()[:5000])
    words = ["delete-trainee", copied / DATABASE, "V0001", "--yes", "--records", folder]
    assert main([str(word) for word in words]) == 1
    printed = capsys.readouterr().out
    assert "2 trials and 2 journals deleted" in printed
    assert f"These journals do not say whose they are, and are left: {unknown}." in printed
    assert not own.exists()
    assert not unfinished.exists()
    assert unknown.exists()


def test_journals_that_would_be_left_elsewhere_are_named(copied, tmp_path, capsys):
    with Study.open(copied / DATABASE) as study:
        ids = [trial.record.trial_id for trial in study.history("V0001")]
    words = [str(word) for word in ("delete-trainee", copied / DATABASE, "V0001", "--yes")]
    assert main(words) == 2
    assert "The journals of V0001 would be left" in capsys.readouterr().err
    (tmp_path / "empty").mkdir()
    assert main([*words, "--records", str(tmp_path / "empty")]) == 1
    printed = capsys.readouterr().out
    assert "2 trials and 0 journals deleted" in printed
    assert "The journals of 2 trials were not found" in printed
    assert all(f"*_{trial_id}.*" in printed for trial_id in ids)


def test_a_journal_being_written_stops_the_deletion_before_it_starts(copied):
    folder = copied / RECORDS
    path = next(p for p in journals(folder) if read_journal(p).header.trainee == "V0001")
    journal = Journal.reopened(read_journal(path))
    journal.write([{"kind": "acknowledged", "simTimeS": 0.0}], sync=False)
    with Study.open(copied / DATABASE) as study:
        with pytest.raises(InputError, match="if the trial is still running, end it first"):
            erase_trainee(study, "V0001", folder)
        assert len(study.history("V0001")) == 2
        journal.close()
        assert erase_trainee(study, "V0001", folder).trials == 2
