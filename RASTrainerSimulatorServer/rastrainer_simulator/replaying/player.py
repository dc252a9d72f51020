"""What is done with a film that is played, and what is read meanwhile."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from enum import Enum

from rastrainer_simulator.controls.control_name import ControlName
from rastrainer_simulator.flow.screen import Hint, Message, Screen, Tone
from rastrainer_simulator.replaying.replay_loop import ReplayLoop
from rastrainer_simulator.texts.texts import Texts

STEP_S = 5.0
SLOWLY = 0.5
"""Speed at which the worst touch is shown."""


class Action(str, Enum):
    """What can be done while a trial is shown again."""

    PLAY = "play"
    BACK = "back"
    FORTH = "forth"
    WORST = "worst"
    CAMERA = "camera"
    END = "end"


ACTIONS: Mapping[ControlName, Action] = {
    ControlName.ACCEPT: Action.PLAY,
    ControlName.PAUSE: Action.PLAY,
    ControlName.LEFT: Action.BACK,
    ControlName.RIGHT: Action.FORTH,
    ControlName.UP: Action.WORST,
    ControlName.CAMERA: Action.CAMERA,
    ControlName.BACK: Action.END,
    ControlName.MENU: Action.END,
}
"""What the controls do meanwhile."""


class Player:
    """Carries out what whoever watches wants.

    Attributes:
        loop: what is played.
    """

    def __init__(self, loop: ReplayLoop, end: Callable[[], None]) -> None:
        """`end` is called when they have seen enough."""
        self.loop = loop
        self._does: Mapping[Action, Callable[[], None]] = {
            Action.PLAY: lambda: loop.pause(loop.is_playing),
            Action.BACK: lambda: loop.play_from(loop.time_s - STEP_S),
            Action.FORTH: lambda: loop.play_from(loop.time_s + STEP_S),
            Action.WORST: self._show_worst,
            Action.CAMERA: self._change_camera,
            Action.END: end,
        }

    def do(self, action: Action) -> None:
        """Do what is wanted."""
        self._does[action]()

    def screen(self, texts: Texts, hints: tuple[Hint, ...], language: str) -> Screen:
        """Return what is read now; `language` is the BCP 47 tag of the texts."""
        loop, say = self.loop, texts.say
        film = loop.film
        task = loop.setup.scenario.task(film.task)
        said = say("replay.title", task=task.title, trainee=film.trainee)
        if film.worst is not None and loop.speed != 1.0:
            said = say("replay.worst", point=film.worst[0])
        kept = len(loop.latest.training.touches)
        status = [
            f"{_clock(loop.time_s)} / {_clock(film.duration_s)}",
            say("status.points", kept=kept, count=len(task.labels)),
        ]
        if not loop.is_playing:
            status.append(say("replay.paused"))
        differs = film.difference is not None
        return Screen(
            instruction=Message(said),
            warnings=(Message(say("replay.differs"), Tone.WARNING),) if differs else (),
            status=tuple(status),
            hints=hints,
            language=language,
            is_stepped=True,
        )

    def _show_worst(self) -> None:
        worst = self.loop.film.worst
        if worst is not None:
            _label, begin, end = worst
            self.loop.play_from(begin, end, SLOWLY)

    def _change_camera(self) -> None:
        names = tuple(self.loop.setup.scenario.cameras)
        if names:
            shown = self.loop.latest.camera
            place = names.index(shown) if shown in names else -1
            self.loop.look(names[(place + 1) % len(names)])


def _clock(seconds: float) -> str:
    minutes, rest = divmod(int(seconds), 60)
    return f"{minutes:02d}:{rest:02d}"
