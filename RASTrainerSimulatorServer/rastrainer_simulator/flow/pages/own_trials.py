"""The trainee's own trials: what became of each, and its replay."""

from __future__ import annotations

from functools import partial

from rastrainer.errors import InputError
from rastrainer_simulator.flow.pages.session_page import SessionPage, page_kind
from rastrainer_simulator.flow.pages.trial_review import ReplayPage
from rastrainer_simulator.flow.session.open_pages import PageContent, PageRow
from rastrainer_simulator.flow.session.trainee_history import OwnTrial

MOST_TRIALS = 12
_VERDICTS = {True: "experiment.passed", False: "experiment.failed", None: "experiment.done"}


@page_kind("own-trials")
def own_trials_page(page: SessionPage) -> PageContent:
    """List the newest trials first; choosing one shows it again."""
    session, say = page.session, page.say

    def show(trial_id: str) -> None:
        try:
            loading = session.load_trial(trial_id)
        except InputError as error:
            session.complain(str(error))
        else:
            session.pages.open(ReplayPage(session, loading, begins_at_worst=False))

    def row(each: OwnTrial) -> PageRow:
        past = each.past
        is_shown = each.scenario == session.scenario.name and not past.is_aborted
        verdict = say(_VERDICTS[each.is_passed])
        when = each.started_utc[:16].replace("T", " ")
        return page.button(
            f"trial {past.trial_id}",
            partial(show, past.trial_id),
            f"{session.task_title(past.task)} ({when} UTC)",
            value=verdict if past.is_aborted else f"{past.score:.0f} / 100, {verdict}",
            is_enabled=is_shown,
            help=say("own-trials.help" if is_shown else "own-trials.not shown"),
        )

    trainee = session.trainee_id
    trials = reversed(session.history.own(trainee)[-MOST_TRIALS:])
    back = page.button("back", label=say("experiment.back"))
    return PageContent(say("own-trials.title", trainee=trainee), rows=(*map(row, trials), back))
