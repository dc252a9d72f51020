"""What leads the tool: a ring near the head, an arrow to a target, bull's-eye and depth gauge."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from vtkmodules.vtkRenderingCore import vtkRenderer

from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.desktop.panels import theme
from rastrainer_simulator.desktop.panels.brush import Brush
from rastrainer_simulator.desktop.panels.canvas import Box, Canvas
from rastrainer_simulator.presentation.look import (
    BULLS_EYE_FARTHEST_MM,
    BULLS_EYE_NEAR_MM,
    BULLS_EYE_RADIUS,
    BULLS_EYE_RINGS_MM,
    CLOSED_RING_M,
    ENTRY_DOT,
    IN_SIGHT_SHARE,
    ON_LINE_DEG,
    ON_LINE_MM,
    RULER_BEYOND_MM,
    RULER_TICK_MM,
    TARGET_RING,
)
from rastrainer_simulator.presentation.messages import ProcedureNews, StateNews
from rastrainer_simulator.presentation.screen import DepthRuler, Tone
from rastrainer_simulator.state import TOUCH_ERRORS, TouchStage
from rastrainer_simulator.texts.texts import Texts

THICKNESS = 4
THICKNESS_ON_SKIN = 9
STEP_PX = 2


@dataclass(frozen=True)
class TouchRing:
    """Where the ring is in the picture, in pixels from the upper left corner."""

    x: int
    y: int
    radius: int
    stage: TouchStage


def touch_ring(
    state: StateNews, tip: np.ndarray, renderer: vtkRenderer, size: tuple[int, int]
) -> TouchRing | None:
    """Return the ring of a state; None where the tip is far from the head or not in the picture.

    Args:
        state: of the simulator, as a view receives it.
        tip: (3,) float, World, m.
        renderer: of the main view.
        size: of the window, in pixels.
    """
    stage = state.touch
    if stage is TouchStage.FAR:
        return None
    camera = renderer.GetActiveCamera()
    matrix = camera.GetCompositeProjectionTransformMatrix(size[0] / size[1], -1.0, 1.0)
    x, y, _z, w = matrix.MultiplyPoint((*tip, 1.0))
    if w <= 0.0 or abs(x) > w or abs(y) > w:
        return None
    half_height_m = w * math.tan(math.radians(camera.GetViewAngle()) / 2.0)
    radius_m = (MM_PER_M * CLOSED_RING_M + max(0.0, state.clearance_mm)) / MM_PER_M
    radius = 0.5 * size[1] * radius_m / half_height_m
    return TouchRing(
        round(0.5 * size[0] * (1.0 + x / w)),
        round(0.5 * size[1] * (1.0 - y / w)),
        STEP_PX * round(radius / STEP_PX),
        stage,
    )


def paint_ring(look: tuple[int, TouchStage], brush: Brush) -> np.ndarray:
    """Return a ring of a radius in pixels, in the color of its stage."""
    radius, stage = look
    is_on_point = stage in (TouchStage.ON_SKIN, TouchStage.PRESSED)
    thickness = brush.px(THICKNESS_ON_SKIN if is_on_point else THICKNESS)
    reach = radius + thickness
    canvas = Canvas(2 * reach, 2 * reach)
    color = theme.ON_SKIN if stage is TouchStage.ON_SKIN else theme.NEAR
    if stage in TOUCH_ERRORS:
        color = theme.CONTACT
    canvas.frame(Box(0, 0, 2 * reach, 2 * reach), color, reach, thickness)
    return canvas.pixels()


@dataclass(frozen=True)
class Direction:
    """From the picture's middle toward a target out of sight.

    Attributes:
        angle_deg: 0 is to the right, 90 up.
        across: −1 is the left edge, 1 the right.
        upward: −1 is the lower edge, 1 the upper.
    """

    angle_deg: float
    across: float
    upward: float


def direction_out_of_sight(
    renderer: vtkRenderer, point: np.ndarray, size: tuple[int, int]
) -> Direction | None:
    """Return the direction to a point (World, m) that the camera does not see, else None."""
    camera = renderer.GetActiveCamera()
    aspect = size[0] / size[1]
    matrix = camera.GetCompositeProjectionTransformMatrix(aspect, -1.0, 1.0)
    x, y, _z, w = matrix.MultiplyPoint((*point, 1.0))
    if w > 0.0 and abs(x) <= IN_SIGHT_SHARE * w and abs(y) <= IN_SIGHT_SHARE * w:
        return None
    # Behind the camera left and right are swapped with the sign of w.
    sign = -1.0 if w < 0.0 else 1.0
    right, up = sign * x * aspect, sign * y
    length = math.hypot(right, up) or 1.0
    right, up = right / length, up / length
    reach = min(
        aspect / abs(right) if right else math.inf,
        1.0 / abs(up) if up else math.inf,
    )
    return Direction(math.degrees(math.atan2(up, right)), right * reach / aspect, up * reach)


_SEEN_STEP_PX = 4


def pixel_of(
    renderer: vtkRenderer, point: np.ndarray, size: tuple[int, int]
) -> tuple[int, int] | None:
    """Return about where a point (World, m) is seen, in pixels from the lower left corner.

    None where it is behind the camera.
    """
    camera = renderer.GetActiveCamera()
    matrix = camera.GetCompositeProjectionTransformMatrix(size[0] / size[1], -1.0, 1.0)
    x, y, _z, w = matrix.MultiplyPoint((*point, 1.0))
    if w <= 0.0:
        return None
    across, up = (
        _SEEN_STEP_PX * round(0.5 * side * (1.0 + share / w) / _SEEN_STEP_PX)
        for side, share in zip(size, (x, y), strict=True)
    )
    return across, up


DISK_RADIUS = 46
REACH = 78
HALF_WIDTH = 30
STEP_DEG = 3.0


def target_arrow(target: tuple[float, int | None], brush: Brush) -> np.ndarray:
    """Return a disk with the distance, and an arrow head on it.

    `target` is an angle in degrees, 0 to the right and 90 up, and a distance in mm; None for the
    tool's arrow, whose color is like that of the tip.
    """
    angle_deg, distance_mm = target
    color = theme.TOOL if distance_mm is None else theme.TARGET
    middle = brush.px(REACH) + 2
    canvas = Canvas(2 * middle, 2 * middle)
    angle = math.radians(angle_deg)
    ahead = np.array([math.cos(angle), -math.sin(angle)])
    aside = np.array([-ahead[1], ahead[0]])
    center = np.array([middle, middle], dtype=float)
    base = center + brush.px(0.6 * DISK_RADIUS) * ahead
    tip = center + brush.px(REACH) * ahead
    corners = (tip, base + brush.px(HALF_WIDTH) * aside, base - brush.px(HALF_WIDTH) * aside)
    canvas.polygon([tuple(corner) for corner in corners], color)
    radius = brush.px(DISK_RADIUS)
    disk = Box(middle - radius, middle - radius, 2 * radius, 2 * radius)
    canvas.box(disk, theme.NIGHT, radius)
    canvas.frame(disk, color, radius, brush.px(4))
    if distance_mm is None:
        return canvas.pixels()
    lines = ((str(distance_mm), theme.STRONG, -0.72), ("mm", theme.SMALL, 0.02))
    for text, style, rise in lines:
        left = middle - brush.width(text, style) // 2
        brush.write(canvas, text, style, theme.TEXT, left, middle + brush.px(rise * DISK_RADIUS))
    return canvas.pixels()


EYE_WIDTH, EYE_HEIGHT = 360, 420

Place = tuple[float, float]


@dataclass(frozen=True)
class BullsEye:
    """What is drawn: right and up of the guide's axis, mm.

    Attributes:
        entry, target: of the planned line.
        entry_mm: distance of the entry from the axis.
        angle_deg: between the line and the axis.
        figures: both, as they are written.
    """

    entry: Place
    target: Place
    entry_mm: float
    angle_deg: float
    figures: tuple[str, str]

    @property
    def is_good(self) -> bool:
        """Whether the guide is on the line, as far as a hand can bring it."""
        return self.entry_mm <= ON_LINE_MM and self.angle_deg <= ON_LINE_DEG


def bulls_eye(procedure: ProcedureNews | None, texts: Texts) -> BullsEye | None:
    """Return what a state's procedure says; None while no guide is aligned."""
    aim = None if procedure is None else procedure.aim
    if aim is None:
        return None
    entry_mm, angle_deg = round(aim.entry_distance_mm, 1), round(aim.angle_deg, 1)
    figures = (texts.say("panel.mm", value=entry_mm), texts.say("panel.deg", value=angle_deg))
    return BullsEye(_place(aim.entry_mm), _place(aim.target_mm), entry_mm, angle_deg, figures)


def shown_radius(distance_mm: float) -> float:
    """Return where a distance is drawn, as a share of the radius: near ones are spread."""
    share = math.log1p(distance_mm / BULLS_EYE_NEAR_MM) / math.log1p(
        BULLS_EYE_FARTHEST_MM / BULLS_EYE_NEAR_MM
    )
    return min(1.0, share)


def paint_bulls_eye(look: BullsEye, brush: Brush) -> np.ndarray:
    """Return the panel: rings of 1, 5 and 20 mm, a dot for the entry and a ring for the target."""
    canvas = Canvas(brush.px(EYE_WIDTH), brush.px(EYE_HEIGHT))
    whole = Box(0, 0, canvas.width, canvas.height)
    canvas.box(whole, theme.GLASS, brush.px(theme.RADIUS))
    middle = canvas.width / 2
    for ring_mm in (*BULLS_EYE_RINGS_MM, BULLS_EYE_FARTHEST_MM):
        _circle(
            canvas,
            (middle, middle),
            brush.px(BULLS_EYE_RADIUS) * shown_radius(ring_mm),
            theme.CAP_EDGE,
            3,
        )
    cross = brush.px(BULLS_EYE_RADIUS)
    for along, across in ((1, 0), (0, 1)):
        ends = [(middle - s * cross * along, middle - s * cross * across) for s in (1, -1)]
        canvas.stroke(ends, brush.px(2), theme.CAP_EDGE)
    color = theme.TONES[Tone.GOOD if look.is_good else Tone.WARNING]
    entry, target = (_shown(place, middle, brush) for place in (look.entry, look.target))
    canvas.stroke([entry, target], brush.px(4), color)
    _circle(canvas, target, brush.px(TARGET_RING), color, brush.px(5))
    dot = brush.px(ENTRY_DOT)
    canvas.box(Box(round(entry[0]) - dot, round(entry[1]) - dot, 2 * dot, 2 * dot), color, dot)
    _write(canvas, look, brush)
    return canvas.pixels()


def _place(values: Place) -> Place:
    right, up = values
    return round(right, 1), round(up, 1)


def _shown(place: Place, middle: float, brush: Brush) -> tuple[float, float]:
    distance = math.hypot(*place)
    if distance == 0.0:
        return middle, middle
    far = brush.px(BULLS_EYE_RADIUS) * shown_radius(distance) / distance
    return middle + far * place[0], middle - far * place[1]


def _circle(
    canvas: Canvas, middle: tuple[float, float], radius: float, color: theme.Color, thickness: int
) -> None:
    left, top, wide = (round(v) for v in (middle[0] - radius, middle[1] - radius, 2 * radius))
    canvas.frame(Box(left, top, wide, wide), color, radius, thickness)


def _write(canvas: Canvas, look: BullsEye, brush: Brush) -> None:
    top = brush.px(EYE_WIDTH) + brush.px(theme.STEP) // 2
    pad = brush.px(theme.PAD)
    right = canvas.width - pad - brush.width(look.figures[1], theme.HEADING)
    for text, left in zip(look.figures, (pad, right), strict=True):
        brush.write(canvas, text, theme.HEADING, theme.TEXT, left, top)


GAUGE_WIDTH, GAUGE_HEIGHT = 360, 520
TRACK_LEFT, TRACK_WIDTH, TRACK_TOP, TRACK_BOTTOM = 80, 36, 76, 24


@dataclass(frozen=True)
class DepthGauge:
    """What is drawn, mm: the scale, and how deep what is in the guide is beyond its tip.

    `figure` is that depth as it is written.
    """

    ruler: DepthRuler
    depth_mm: float
    figure: str

    @property
    def longest_mm(self) -> float:
        """Length of the scale."""
        return max(self.ruler.target_mm, self.depth_mm, 1.0) + RULER_BEYOND_MM


def depth_gauge(
    ruler: DepthRuler | None, procedure: ProcedureNews | None, texts: Texts
) -> DepthGauge | None:
    """Return what a screen's ruler and a state's procedure say; None while nothing is fed."""
    if ruler is None or procedure is None:
        return None
    depth_mm = round(procedure.feed_mm, 1)
    return DepthGauge(ruler, depth_mm, texts.say("panel.mm", value=depth_mm))


def paint_gauge(look: DepthGauge, brush: Brush) -> np.ndarray:
    """Return the panel: depths from the top down, bone as a pale band, lines at the marks."""
    canvas = Canvas(brush.px(GAUGE_WIDTH), brush.px(GAUGE_HEIGHT))
    canvas.box(Box(0, 0, canvas.width, canvas.height), theme.GLASS, brush.px(theme.RADIUS))
    top, bottom = brush.px(TRACK_TOP), brush.px(GAUGE_HEIGHT - TRACK_BOTTOM)
    left, wide = brush.px(TRACK_LEFT), brush.px(TRACK_WIDTH)

    def y(depth_mm: float) -> int:
        return round(top + (bottom - top) * max(depth_mm, 0.0) / look.longest_mm)

    canvas.box(Box(left, top, wide, bottom - top), theme.FIELD, 4)
    ruler = look.ruler
    if ruler.outer_mm is not None and ruler.inner_mm is not None:
        bone = Box(left, y(ruler.outer_mm), wide, max(1, y(ruler.inner_mm) - y(ruler.outer_mm)))
        canvas.box(bone, theme.CAP_EDGE, 0)
    canvas.box(Box(left + wide // 3, top, wide // 3, y(look.depth_mm) - top), theme.ACCENT, 0)
    for tick in np.arange(0.0, look.longest_mm, RULER_TICK_MM):
        canvas.box(Box(left - brush.px(14), y(tick), brush.px(14), 2), theme.TEXT_PALE, 0)
        if tick % (2 * RULER_TICK_MM) == 0.0:
            text = f"{tick:.0f}"
            start = left - brush.px(22) - brush.width(text, theme.SMALL)
            height = brush.line_height(theme.SMALL)
            brush.write(canvas, text, theme.SMALL, theme.TEXT_SOFT, start, y(tick) - height // 2)
    _marks(canvas, look, brush, y)
    brush.write(canvas, look.figure, theme.HEADING, theme.TEXT, brush.px(theme.PAD), brush.px(18))
    return canvas.pixels()


def _marks(canvas: Canvas, look: DepthGauge, brush: Brush, y: Callable[[float], int]) -> None:
    """Mark entry, tables of the skull and target, with depths and names beside the track."""
    ruler = look.ruler
    depths = (ruler.entry_mm, ruler.outer_mm, ruler.inner_mm, ruler.target_mm)
    tones = (Tone.GOOD, Tone.WARNING, Tone.WARNING, Tone.GOOD)
    left = brush.px(TRACK_LEFT) - 4
    wide = brush.px(TRACK_WIDTH) + 4 + brush.px(20)
    lowest, height = -canvas.height, brush.line_height(theme.SMALL)
    for depth_mm, tone, name in zip(depths, tones, ruler.names, strict=True):
        if depth_mm is None:
            continue
        color = theme.TONES[tone]
        canvas.box(Box(left, y(depth_mm) - 2, wide, 4), color, 0)
        # Outer and inner table are near each other: their figures must not cover each other.
        lowest = max(y(depth_mm) - height // 2, lowest + height)
        start = left + wide + brush.px(8)
        room = canvas.width - start - brush.px(8)
        text = brush.fit(f"{depth_mm:.0f} {name}", theme.SMALL, room)
        brush.write(canvas, text, theme.SMALL, color, start, lowest)
