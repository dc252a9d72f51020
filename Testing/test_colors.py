"""Colors that tell things apart do so for people who are blind to red, green or blue, too."""

from __future__ import annotations

from itertools import combinations

import pytest
from coloraide import Color

from rastrainer.procedure.errors import PLACED_COLOR, PLANNED_COLOR, REGISTERED_COLOR
from rastrainer_simulator.presentation import look
from rastrainer_simulator.presentation.screen import Tone
from rastrainer_simulator.scene import nodes

LEAST_DIFFERENCE = 19.0
"""CIEDE2000; 1 is about what can be seen side by side."""
LEAST_CONTRAST = 4.5
"""WCAG 2.1, 1.4.3."""
KINDS_OF_SIGHT = ("", "protan", "deutan", "tritan")
TOLD_APART = {
    "tones": list(look.TONES.values()),
    "banners": list(look.BANNERS.values()),
    "tip": [
        each.color for each in (nodes.TIP_FREE, nodes.TIP_NEAR, nodes.TIP_ON_SKIN, nodes.TIP_ERROR)
    ],
    "fiducials": [each.color for each in (nodes.WAITING, nodes.NEXT, nodes.TOUCHED)],
    "lines of a procedure": [PLANNED_COLOR, REGISTERED_COLOR, PLACED_COLOR],
}


def as_color(values) -> Color:
    return Color(values) if isinstance(values, str) else Color("srgb", list(values[:3]))


def seen(color: Color, sight: str) -> Color:
    """Return what a color looks like to someone with that deficiency, wholly, or with none."""
    return color.filter(sight) if sight else color


@pytest.mark.parametrize("sight", KINDS_OF_SIGHT, ids=lambda sight: sight or "all cones")
@pytest.mark.parametrize("name", TOLD_APART)
def test_colors_with_different_meanings_differ_for_every_kind_of_color_vision(name, sight):
    shown = [seen(as_color(values), sight) for values in TOLD_APART[name]]
    differences = [one.delta_e(other, method="2000") for one, other in combinations(shown, 2)]
    assert min(differences) >= LEAST_DIFFERENCE


@pytest.mark.parametrize("tone", Tone, ids=lambda tone: tone.value)
def test_text_is_legible_in_every_tone_and_on_every_banner(tone):
    text, panel = as_color(look.TEXT), as_color(look.NIGHT)
    assert as_color(look.TONES[tone]).contrast(panel) >= LEAST_CONTRAST
    assert text.contrast(as_color(look.BANNERS[tone])) >= LEAST_CONTRAST
