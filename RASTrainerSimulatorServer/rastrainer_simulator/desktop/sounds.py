"""Play the sounds of the simulator's events through SDL."""

from __future__ import annotations

import logging
from collections.abc import Iterable

import pygame

from rastrainer_simulator.assets import asset_path

CHANNELS = 8
BUFFER_SAMPLES = 512

_log = logging.getLogger(__name__)


class Sounds:
    """The loudspeaker; silent where there is none."""

    def __init__(self) -> None:
        self._sounds: dict[str, pygame.mixer.Sound] = {}
        try:
            pygame.mixer.init(buffer=BUFFER_SAMPLES)
        except pygame.error as error:
            _log.warning("There will be no sound: %s", error)
            return
        pygame.mixer.set_num_channels(CHANNELS)
        for path in sorted(asset_path("sounds").glob("*.wav")):
            self._sounds[path.stem] = pygame.mixer.Sound(path)

    @property
    def names(self) -> Iterable[str]:
        """The sounds there are."""
        return self._sounds.keys()

    def play(self, name: str, volume: float) -> bool:
        """Play a sound at a volume from 0 to 1; return whether it can be heard."""
        sound = self._sounds.get(name)
        if sound is None or volume <= 0.0:
            return False
        channel = sound.play()
        if channel is None:
            return False
        channel.set_volume(min(1.0, volume))
        return True

    def close(self) -> None:
        """Give the loudspeaker back."""
        pygame.mixer.quit()
