"""The trainee's own trials: what became of each, and its replay."""

from __future__ import annotations

from rastrainer.errors import InputError
from rastrainer_simulator.flow.pages.session_page import SessionPage
from rastrainer_simulator.flow.pages.trial_review import ReplayPage
from rastrainer_simulator.flow.session.trainee_history import OwnTrial
from rastrainer_simulator.presentation.screen import Menu, MenuItem

MOST_TRIALS = 12
_TRIAL = "trial "
_VERDICTS = {True: "experiment.passed", False: "experiment.failed", None: "experiment.done"}


class OwnTrialsPage(SessionPage):
    """Lists the newest trials first; choosing one shows it again."""

    name = "own-trials"

    def menu(self) -> Menu:
        """Return the list; a trial on another head cannot be shown on this one."""
        trials = self.session.history.own(self.session.trainee.strip())
        items = tuple(self._item(each) for each in reversed(trials[-MOST_TRIALS:]))
        title = self.say("own-trials.title", trainee=self.session.trainee.strip())
        back = self.button("back", self.say("experiment.back"))
        return Menu(self.name, title, items=(*items, back))

    def accept(self, item: str) -> None:
        """Show a trial again, or go back."""
        if item == "back":
            self.back()
            return
        try:
            loading = self.session.load_trial(item.removeprefix(_TRIAL))
        except InputError as error:
            self.session.complain(str(error))
        else:
            self.session.pages.open(ReplayPage(self.session, loading, begins_at_worst=False))

    def _item(self, each: OwnTrial) -> MenuItem:
        past = each.past
        is_here = each.scenario == self.session.scenario.name
        verdict = self.say(_VERDICTS[each.is_passed])
        value = verdict if past.is_aborted else f"{past.score:.0f} / 100, {verdict}"
        when = each.started_utc[:16].replace("T", " ")
        help_ = "own-trials.help" if is_here and not past.is_aborted else "own-trials.not shown"
        return MenuItem(
            _TRIAL + past.trial_id,
            f"{self.session.task_title(past.task)} ({when} UTC)",
            value=value,
            is_enabled=is_here and not past.is_aborted,
            help=self.say(help_),
        )
