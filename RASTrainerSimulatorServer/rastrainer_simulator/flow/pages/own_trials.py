"""The trainee's own trials: what became of each, and its replay."""

from __future__ import annotations

from functools import partial

from rastrainer.errors import InputError
from rastrainer_simulator.flow.pages.session_page import SessionPage
from rastrainer_simulator.flow.pages.trial_review import ReplayPage
from rastrainer_simulator.flow.session.open_pages import PageContent, PageRow
from rastrainer_simulator.flow.session.trainee_history import OwnTrial

MOST_TRIALS = 12
_VERDICTS = {True: "experiment.passed", False: "experiment.failed", None: "experiment.done"}


class OwnTrialsPage(SessionPage):
    """Lists the newest trials first; choosing one shows it again."""

    name = "own-trials"

    def content(self) -> PageContent:
        trainee = self.session.trainee_id
        trials = reversed(self.session.history.own(trainee)[-MOST_TRIALS:])
        back = self.button("back", label=self.say("experiment.back"))
        title = self.say("own-trials.title", trainee=trainee)
        return PageContent(title, rows=(*map(self._trial, trials), back))

    def _trial(self, each: OwnTrial) -> PageRow:
        """Return a trial; one on another head cannot be shown on this one."""
        past = each.past
        is_shown = each.scenario == self.session.scenario.name and not past.is_aborted
        verdict = self.say(_VERDICTS[each.is_passed])
        when = each.started_utc[:16].replace("T", " ")
        return self.button(
            f"trial {past.trial_id}",
            partial(self._show, past.trial_id),
            f"{self.session.task_title(past.task)} ({when} UTC)",
            value=verdict if past.is_aborted else f"{past.score:.0f} / 100, {verdict}",
            is_enabled=is_shown,
            help=self.say("own-trials.help" if is_shown else "own-trials.not shown"),
        )

    def _show(self, trial_id: str) -> None:
        try:
            loading = self.session.load_trial(trial_id)
        except InputError as error:
            self.session.complain(str(error))
        else:
            self.session.pages.open(ReplayPage(self.session, loading, begins_at_worst=False))
