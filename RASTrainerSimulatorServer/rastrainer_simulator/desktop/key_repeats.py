"""Repeats of a held key, as the user saw them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import pygame


def without_late_repeats(
    events: Sequence[pygame.event.Event], is_held: Callable[[int], bool]
) -> list[pygame.event.Event]:
    """Return the events of one look, with at most one repeat of a key, and none once it is up.

    SDL repeats a key until its release is looked at. A window that draws for a second has looked at
    nothing meanwhile: a key that was only tapped would type a row of letters.

    `is_held` tells whether a key, by its SDL scancode, was down before.
    """
    late: set[int] = set()
    first: dict[int, int] = {}
    down: dict[int, bool] = {}
    for index, event in enumerate(events):
        if event.type == pygame.KEYDOWN:
            is_repeat = down.get(event.scancode, is_held(event.scancode))
            if is_repeat and first.setdefault(event.scancode, index) != index:
                late.add(index)
            down[event.scancode] = True
        elif event.type == pygame.KEYUP:
            late.update([first.pop(event.scancode)] if event.scancode in first else [])
            down[event.scancode] = False
    return [event for index, event in enumerate(events) if index not in late]
