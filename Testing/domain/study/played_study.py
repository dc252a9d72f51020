"""A small study with a protocol, trials, answers and skipped steps."""

from dataclasses import replace
from pathlib import Path

from rastrainer.protocol import StepKind
from rastrainer.study.database.study import Study
from rastrainer.study.protocol.questionnaires import find_questionnaire
from rastrainer.study.protocol.study_progress import StudyProgress
from rastrainer.study.protocol.study_protocol import StudyProtocol
from Testing.domain.trial.trial_records import gentle_score, make_record

STUDIES = Path(__file__).parents[3] / "assets" / "studies"


def study_with_trials(path, consent=True):
    """A has done all steps and repeated the last task, B only the first trial."""
    # In one transaction: each alone costs a sync of the disk.
    with Study.open(path) as study, study.database.writing():
        progress = StudyProgress(study)
        published = StudyProtocol.read(STUDIES / "published-protocol.json")
        progress.set_protocol(replace(published, tasks=("task-1",)))
        for name in ("A", "B"):
            study.create_trainee(name, consent=consent if name == "A" else True)
            progress.enroll(name)
        progress.skip("B", "desktop/trial-run", "knows the tasks from a pilot")
        for step in progress.progress("A").steps:
            if step.kind is StepKind.TRIAL:
                play(study, "A", step.mode)
                progress.count_played("A")
            elif step.kind is StepKind.QUESTIONNAIRE:
                count = len(find_questionnaire(step.questionnaire).items)
                progress.finish("A", step.name, {"answers": [1] * count})
            else:
                progress.finish("A", step.name, {"minutes": step.minutes})
        play(study, "A", "desktop")
        play(study, "B", "desktop")
        progress.count_played("B")


def play(study, trainee, mode):
    number = sum(len(study.history(name)) for name in ("A", "B"))
    utc = f"2999-01-01T10:0{number}:00Z"
    moment = {"startedUtc": utc, "completedUtc": utc}
    record = make_record(number, mode=mode, trainee=trainee, motion={"sparc": -2.5}, **moment)
    study.add_trial(record, score=gentle_score(110.0, 0.5))
