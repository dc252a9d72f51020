"""A trainee of the flow, at the tutorial."""

from __future__ import annotations

from rastrainer.transforms import MM_PER_M


class FlowLearner:
    """Does what `TutorialPlayer` asks for in the flow's own process."""

    def __init__(self, trainee):
        self.trainee = trainee
        self.hands, self.until = trainee.hands, trainee.until

    @property
    def screen(self):
        return self.trainee.presenter.screen

    def turn_view(self):
        self.hands.hold("view_right", True)
        self.trainee.step(30)
        self.hands.hold("view_right", False)
        self.trainee.step()

    def lower(self):
        self.trainee.lower_onto(*self._next())

    def touch_next(self):
        self.trainee.touch(*self._next())

    def resume(self):
        self.trainee.choose("resume", None)

    def _next(self):
        practice = self.trainee.presenter._session.tutorial.practice
        truth = practice.training.truth
        point = truth.in_world(truth.fiducials_ras[practice.training.state.next_point]) / MM_PER_M
        return point, truth.in_world(truth.target_ras) / MM_PER_M
