"""Colors, sizes and times that all views share; `tools/page_types.py` writes it for the page.

Colors are sRGB. Lengths of panels are units: one is a pixel where the window is 1920 × 1080.
"""

from __future__ import annotations

from collections.abc import Mapping

from rastrainer import protocol
from rastrainer_simulator import state
from rastrainer_simulator.presentation.screen import Tone
from rastrainer_simulator.scene import nodes
from rastrainer_simulator.trial_state import Tool

TOUCH_ERRORS = state.TOUCH_ERRORS

TONES: Mapping[Tone, str] = {
    Tone.PLAIN: "#3f8fe0",
    Tone.GOOD: "#8ff0d0",
    Tone.WARNING: "#ffe000",
    Tone.ERROR: "#ef5f66",
}
BANNERS: Mapping[Tone, str] = {
    Tone.PLAIN: "#0f2f70",
    Tone.GOOD: "#35786a",
    Tone.WARNING: "#806f00",
    Tone.ERROR: "#700d18",
}
NIGHT, TEXT = "#0e1726", "#f4f7fb"
"""Colors of a panel and of the text in it."""
TARGET_COLOR = "#ffe14a"
"""Color of the arrow to a next point that is out of sight."""

SCENE_COLORS: Mapping[str, nodes.Color] = {
    "waiting": nodes.WAITING.color,
    "next": nodes.NEXT.color,
    "touched": nodes.TOUCHED.color,
    "free": nodes.TIP_FREE.color,
    "near": nodes.TIP_NEAR.color,
    "onSkin": nodes.TIP_ON_SKIN.color,
    "error": nodes.TIP_ERROR.color,
    "traced": nodes.TRACED.color,
    "covered": nodes.COVERED.color,
    "ghost": nodes.GHOST.color,
}
PULSE_COLOR = (1.0, 0.97, 0.75)
"""Brightest color of the next fiducial, which pulses once every `PULSE_S`; linear RGB."""
PULSE_S = 1.4
GHOST_OPACITY = nodes.GHOST_OPACITY
CLEAR_SKIN_OPACITY = 0.3
COVER_OPACITY = 0.3
"""Opacity of a body that covers the tip or the next point."""

TOOL_NODES: Mapping[Tool, tuple[str, ...]] = {
    Tool.POINTER: (),
    Tool.GUIDE: ("guide", "axis"),
    Tool.DRILL: ("guide", "drill"),
    Tool.ELECTRODE: ("guide", "electrode"),
}
"""Nodes that are shown with each tool of a procedure."""
INSTRUMENTS = ("drill", "electrode")
"""Nodes scaled to their insertion depth; they are 1 m long in the glTF."""

FLIGHT_S = 0.7
"""Time that the view takes from one camera to another."""
IN_SIGHT_SHARE = 0.9
"""How much of the picture, from its middle, counts as in sight."""

CLOSED_RING_M = 0.005
"""Radius of the ring around the tip on the skin; above, it is larger by the clearance."""
ARROW_RADIUS_M, ARROW_BALL_M = 0.001, 0.0022
"""Radius of an error arrow's shaft, and of the ball at its end."""

MAX_TRACE_POINTS = protocol.MAX_TRACE_POINTS
TRACE_MARK_M = 0.0011
TRACE_RING_M, TRACE_RIM_M = (0.0052, 0.0075), (0.0075, 0.0088)
"""Inner and outer radius of the ring at the place to draw next, and of its dark rim."""
TRACE_LIFT_M = 0.003
"""Height of the ring above the skin: it is flat, and the skin is not."""
TRACE_RING_SIDES = 40
FULL_PAINT_SHARE = 0.5
"""Up to this share of the covered distance the paint is full; from there on it fades."""

BULLS_EYE_RADIUS = 156
BULLS_EYE_RINGS_MM = (1, 5, 20)
BULLS_EYE_FARTHEST_MM, BULLS_EYE_NEAR_MM = 60, 0.6
"""Distance at the outer edge, and distance from which the scale is logarithmic."""
ON_LINE_MM, ON_LINE_DEG = 0.5, 0.5
"""Within this distance, a hand is on the planned line."""
ENTRY_DOT, TARGET_RING = 9, 15
RULER_TICK_MM, RULER_BEYOND_MM = 10, 10
"""How far the ruler goes past the target."""
