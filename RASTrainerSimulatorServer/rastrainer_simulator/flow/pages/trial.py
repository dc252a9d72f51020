"""The pages over a trial that is open: the menu, what is paused, giving up, registering."""

from __future__ import annotations

from rastrainer.protocol import TRIAL_RUN, AbortReason, CommandName, Phase
from rastrainer_simulator.flow.pages.introduction import ControlsPage
from rastrainer_simulator.flow.pages.match import MatchPage, look_at_match
from rastrainer_simulator.flow.pages.session_page import SessionPage
from rastrainer_simulator.flow.pages.start import SettingsPage
from rastrainer_simulator.input.inputs import ControlName
from rastrainer_simulator.net.views.screen import Menu


class TrialPage(SessionPage):
    """The menu during a trial, which is paused while it is open."""

    name = "trial"

    def menu(self) -> Menu:
        """Return what one can do with the trial."""
        training = self.session.training
        task = self.session.task_title(training.task)
        is_complete = training.phase is Phase.COMPLETE
        items = ["resume", "controls", "settings"]
        if training.touches and is_complete:
            items[1:1] = ["register"]
        items.append("finish" if training.task == TRIAL_RUN else "abort")
        key = "trial.complete" if is_complete else "trial.paused"
        traced = 0 if training.trace is None else len(training.trace.points)
        key = f"{key} trace" if traced else key
        return Menu(
            self.name,
            self.say("trial.title", task=task),
            (self.say(key, trainee=training.trainee, kept=len(training.touches), traced=traced),),
            items=tuple(self.button(item) for item in items),
        )

    def accept(self, item: str) -> None:
        """Do what was chosen."""
        session = self.session
        if item == "resume":
            self.back()
        elif item == "register":
            self._register()
        elif item == "finish":
            session.do(CommandName.ABORT, {"reason": AbortReason.TRAINEE.value})
        else:
            pages = {"controls": ControlsPage, "settings": SettingsPage, "abort": AbortPage}
            session.pages.open(pages[item](session))

    def back(self) -> None:
        """Resume the trial."""
        if self.session.training.phase is Phase.PAUSED:
            self.session.do(CommandName.RESUME)
        else:
            self.session.pages.close()

    def _register(self) -> None:
        """Register the trial; where there is a trace, its match is looked at first."""
        session = self.session
        if session.training.trace is None:
            session.do(CommandName.REGISTER)
        else:
            looked = look_at_match(session.training, session.scenario)
            session.pages.open(MatchPage(session, looked))

    def pressed(self, control: ControlName) -> bool:
        """The control that pauses also resumes."""
        if control is ControlName.PAUSE:
            self.back()
        return control is ControlName.PAUSE


class AbortPage(SessionPage):
    """Asks once more before a trial is given up."""

    name = "abort"
    first = "keep"

    def menu(self) -> Menu:
        """Return the question."""
        training = self.session.training
        text = self.say("abort.text", trainee=training.trainee, kept=len(training.touches))
        items = (self.button("keep"), self.button("abort"))
        return Menu(self.name, self.say("abort.title"), (text,), items=items)

    def accept(self, item: str) -> None:
        """Keep the trial or give it up."""
        if item == "abort":
            self.session.do(CommandName.ABORT, {"reason": AbortReason.TRAINEE.value})
        else:
            self.session.pages.close()


class PracticePage(SessionPage):
    """The trial run's minutes are over: the trainee decides how to continue."""

    name = "practice"
    first = "resume"

    def menu(self) -> Menu:
        """Return the choice."""
        items = (self.button("finish"), self.button("resume"))
        trainee = self.session.training.trainee
        is_led = self.session.study.step_of(trainee) is not None
        text = self.say("practice.study" if is_led else "practice.text", trainee=trainee)
        return Menu(self.name, self.say("practice.title"), (text,), items=items)

    def accept(self, item: str) -> None:
        """Finish, or keep practicing."""
        if item == "finish":
            self.session.note_done()
            self.session.do(CommandName.ABORT, {"reason": AbortReason.PRACTICE_OVER.value})
        else:
            self.session.do(CommandName.RESUME)

    def back(self) -> None:
        """Keep practicing."""
        self.accept("resume")


class CompletePage(SessionPage):
    """All points are touched: they are registered, or the last one is undone."""

    name = "complete"

    def menu(self) -> Menu:
        """Return the choice."""
        training = self.session.training
        items = tuple(self.button(item) for item in ("register", "undo", "abort"))
        text = self.say("complete.text", trainee=training.trainee, count=len(training.touches))
        return Menu(self.name, self.say("complete.title"), (text,), items=items)

    def accept(self, item: str) -> None:
        """Do what was chosen."""
        if item == "abort":
            self.session.pages.open(AbortPage(self.session))
        else:
            self.session.do(CommandName.REGISTER if item == "register" else CommandName.UNDO)
