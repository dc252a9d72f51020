"""The actions and texts of a recorded trial that is played."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from enum import Enum

from rastrainer_simulator.input.control_name import ControlName
from rastrainer_simulator.net.views.screen import Hint, Screen, ScreenMessage
from rastrainer_simulator.ops.texts.texts import Texts
from rastrainer_simulator.replay.playback import Playback

STEP_S = 5.0
SLOWLY = 0.5
"""Speed at which the worst touch is shown."""


class PlayerAction(str, Enum):
    """What can be done while a trial is shown again."""

    PLAY = "play"
    BACK = "back"
    FORWARD = "forward"
    WORST = "worst"
    CAMERA = "camera"
    END = "end"


ACTIONS: Mapping[ControlName, PlayerAction] = {
    ControlName.ACCEPT: PlayerAction.PLAY,
    ControlName.PAUSE: PlayerAction.PLAY,
    ControlName.LEFT: PlayerAction.BACK,
    ControlName.RIGHT: PlayerAction.FORWARD,
    ControlName.UP: PlayerAction.WORST,
    ControlName.CAMERA: PlayerAction.CAMERA,
    ControlName.BACK: PlayerAction.END,
    ControlName.MENU: PlayerAction.END,
}
"""What the controls do meanwhile."""


class Player:
    """Carries out the viewer's actions.

    Attributes:
        playback: the trial.
    """

    def __init__(self, playback: Playback, end: Callable[[], None]) -> None:
        """`end` is called when the viewer ends it."""
        self.playback = playback
        self._handlers: Mapping[PlayerAction, Callable[[], None]] = {
            PlayerAction.PLAY: lambda: playback.pause(playback.is_playing),
            PlayerAction.BACK: lambda: playback.play_from(playback.time_s - STEP_S),
            PlayerAction.FORWARD: lambda: playback.play_from(playback.time_s + STEP_S),
            PlayerAction.WORST: self._show_worst,
            PlayerAction.CAMERA: self._change_camera,
            PlayerAction.END: end,
        }

    def do(self, action: PlayerAction) -> None:
        """Carry out an action."""
        self._handlers[action]()

    def screen(self, texts: Texts, hints: tuple[Hint, ...], language: str) -> Screen:
        """Return the present screen; `language` is the BCP 47 tag of the texts."""
        playback, say = self.playback, texts.say
        trial = playback.trial
        task = playback.setup.scenario.task(trial.task)
        instruction = say("replay.title", task=task.title, trainee=trial.trainee)
        if trial.worst is not None and playback.speed != 1.0:
            instruction = say("replay.worst", point=trial.worst[0])
        kept = len(playback.latest.training.touches)
        status = [
            f"{_clock(playback.time_s)} / {_clock(trial.duration_s)}",
            say("status.points", kept=kept, count=len(task.labels)),
        ]
        if not playback.is_playing:
            status.append(say("replay.paused"))
        return Screen(
            instruction=ScreenMessage(instruction),
            status=tuple(status),
            hints=hints,
            language=language,
            is_stepped=True,
        )

    def _show_worst(self) -> None:
        worst = self.playback.trial.worst
        if worst is not None:
            _label, begin, end = worst
            self.playback.play_from(begin, end, SLOWLY)

    def _change_camera(self) -> None:
        names = tuple(self.playback.setup.scenario.cameras)
        if names:
            shown = self.playback.latest.camera
            place = names.index(shown) if shown in names else -1
            self.playback.use_camera(names[(place + 1) % len(names)])


def _clock(seconds: float) -> str:
    minutes, rest = divmod(int(seconds), 60)
    return f"{minutes:02d}:{rest:02d}"
