"""A small picture in a menu, such as of a head that can be chosen."""

from __future__ import annotations

import io

import numpy as np
import pygame

from rastrainer.errors import InputError


class Thumbnail:
    """A picture that can be had in any size; two are the same only if they are one."""

    def __init__(self, surface: pygame.Surface):
        self._surface = surface

    @classmethod
    def from_png(cls, content: bytes) -> Thumbnail:
        """Return the picture of a PNG file.

        Raises:
            InputError: it is none.
        """
        try:
            surface = pygame.image.load(io.BytesIO(content), "picture.png")
        except pygame.error as error:
            raise InputError(f"A picture of the simulator cannot be read: {error}.") from None
        # Of 24 bits, whatever the file has.
        plain = pygame.Surface(surface.get_size(), depth=24)
        plain.blit(surface, (0, 0))
        return cls(plain)

    def fitted(self, width: int, height: int) -> np.ndarray:
        """Return it as large as fits, (height, width, 3) uint8, the top row first."""
        across, down = self._surface.get_size()
        factor = min(width / across, height / down)
        size = (max(1, round(factor * across)), max(1, round(factor * down)))
        scaled = pygame.transform.smoothscale(self._surface, size)
        return pygame.surfarray.array3d(scaled).transpose(1, 0, 2)
