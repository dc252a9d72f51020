"""A learner at a view of the simulator, in the tutorial."""

from __future__ import annotations

from contextlib import suppress

from Testing.end_to_end.stream_trainee import StreamTrainee
from Testing.end_to_end.window_process import wait_until


class ViewLearner:
    """Does what `TutorialPlayer` asks for, except turning the view."""

    def __init__(self, trainee: StreamTrainee):
        self.trainee = trainee
        self.hands, self.until = trainee.hands, trainee.until

    @property
    def screen(self):
        return self.trainee.view.screen

    def lower(self):
        label = self.trainee.view.state["next"]
        while self.trainee.view.state["touch"] != "on skin":
            self.trainee.approach(label, 0.02)
            self.trainee.lower_onto(label)

    def touch_next(self):
        trainee, label = self.trainee, self.trainee.view.state["next"]

        def is_done():
            return trainee.view.state["next"] != label

        while not is_done():
            trainee.approach(label, 0.02)
            if trainee.lower_onto(label):
                refused = trainee.refused
                is_answered = lambda r=refused: is_done() or trainee.refused > r  # noqa: E731
                trainee.hands.tap("touch")
                with suppress(AssertionError):
                    wait_until(is_answered, f"touch {label}", trainee.again_s)

    def resume(self):
        self.trainee.choose("resume")
        self.trainee.until_menu(None)
