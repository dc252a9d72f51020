"""A picture of a finished procedure: plan, registered line and placed instrument in the head."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import vtkmodules.vtkRenderingFreeType  # noqa: F401  (registers the text)
from vtkmodules.vtkRenderingCore import vtkRenderer, vtkTextActor

from rastrainer import transforms
from rastrainer.head.mesh import HeadMesh
from rastrainer.procedure.errors import PLACED_COLOR, PLANNED_COLOR, REGISTERED_COLOR
from rastrainer.procedure.plan import Procedure
from rastrainer.procedure.record import ProcedureRecord
from rastrainer.scenario.scenario import Camera
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.rendering.lighting import Shadows, light_room
from rastrainer_simulator.rendering.picture import frames, lay_in_corner, node_actors, write_png
from rastrainer_simulator.scene.nodes import NO_GO, SKIN, Material, Node
from rastrainer_simulator.scene.scene_glb import plan_node
from rastrainer_simulator.scene.surfaces import shaded, turned
from rastrainer_simulator.vectors import any_perpendicular, vector

INK = (28, 36, 51)
MARGIN, ROW, SWATCH = 24, 34, (46, 8)
"""Pixels: to the edges, from row to row, and width and height of a line of the legend."""
TEXT_SIZE, THICK = 22, 6
LONGEST_BAR = 0.25
"""Largest length of a scale, as a share of the picture's height."""

Legend = Sequence[tuple[Material, str]]


def bar_mm(height_mm: float) -> float:
    """Return how long the bar is in a picture of that height: 1, 2 or 5 times a power of ten."""
    longest = LONGEST_BAR * height_mm
    power = 10.0 ** math.floor(math.log10(longest))
    return power * max(step for step in (1.0, 2.0, 5.0) if step * power <= longest)


def paint_scale(pixels: np.ndarray, height_mm: float) -> None:
    """Paint the bar; `pixels` is (height, width, 3) uint8, its height showing so many mm."""
    height, width, _colors = pixels.shape
    long = round(bar_mm(height_mm) / height_mm * height)
    _paint(pixels, width - MARGIN - long, MARGIN, long, THICK, np.array(INK))


def _write(renderer: vtkRenderer, text: str, left: int, bottom: int) -> vtkTextActor:
    actor = vtkTextActor()
    actor.SetInput(text)
    actor.SetDisplayPosition(left, bottom)
    style = actor.GetTextProperty()
    style.SetFontFamilyToArial()
    style.SetFontSize(TEXT_SIZE)
    style.SetColor(*(value / 255.0 for value in INK))
    renderer.AddViewProp(actor)
    return actor


def _paint(
    pixels: np.ndarray, left: int, middle: int, long: int, thick: int, color: np.ndarray
) -> None:
    """Paint a level bar at a height above the lower edge."""
    row = pixels.shape[0] - middle
    pixels[row - thick // 2 : row - thick // 2 + thick, left : left + long] = color


CLEAR_SKIN = replace(SKIN, name="clear_skin", opacity=0.25)
PLANNED = Material("planned", PLANNED_COLOR, glowing=True)
SHOWN = Material("shown", REGISTERED_COLOR, glowing=True)
PLACED = Material("placed", PLACED_COLOR, glowing=True)
LEGEND = (
    (PLANNED, "planned"),
    (SHOWN, "as the registration showed it"),
    (PLACED, "placed"),
    (NO_GO, "no-go structure"),
)
LINE_MM, BALL_MM = 0.45, 1.6
SIZE = (1600, 1000)
AWAY_MM, ANGLE_DEG = 420.0, 26.0
"""The camera's distance from the middle of all lines, and its view angle."""
INSET_SHARE, INSET_ERRORS = 0.27, 5.0
"""Size of the picture of the first target in the corner; it is so many errors high."""
LEAST_ERROR_MM = 0.2
FROM = np.array([0.75, 0.75, 0.35])
"""Where it looks from, RAS: the patient's right front, from above."""

Line = tuple[np.ndarray, np.ndarray]


def procedure_lines(
    record: ProcedureRecord, procedure: Procedure, head_to_world: np.ndarray
) -> list[tuple[Line, Line, Line]]:
    """Return for each trajectory the planned, the shown and the placed line, truly, RAS mm.

    `head_to_world` is the true pose, (4, 4) float, mm.
    """
    to_ras = transforms.inverse(head_to_world)
    shown_to_ras = to_ras @ transforms.inverse(record.accepted.world_to_head)
    lines = []
    for plan, one in zip(procedure.trajectories, record.instruments, strict=True):
        planned = np.array([plan.entry_ras, plan.target_ras])
        ends = np.array([one.guide_tip_mm, one.at_depth(one.instrument_depth_mm)])
        shown, placed = transforms.apply(shown_to_ras, planned), transforms.apply(to_ras, ends)
        lines.append(((planned[0], planned[1]), (shown[0], shown[1]), (placed[0], placed[1])))
    return lines


def draw_procedure(
    path: Path, head: HeadMesh, procedure: Procedure, lines: Sequence[tuple[Line, Line, Line]]
) -> None:
    """Write a PNG of a head that is seen through, with its no-go structures and lines.

    The plan is green, the registered line yellow, the placed instrument blue, as the legend says.
    The corner shows the ends of the first three, magnified. Each picture has a bar of some mm: it
    is true at the depth of the lines.
    """
    nodes = [Node("skin", (shaded(head.vertices / MM_PER_M, head.triangles, CLEAR_SKIN),))]
    nodes += [replace(node, is_hidden=False) for node in plan_node([procedure]).children]
    both: np.ndarray = np.array(lines)[:, :, ::-1].reshape(-1, 2, 3)
    middle = both.mean(axis=0).sum(axis=0) / 2
    pixels = _picture([*nodes, *_line_nodes(lines, 1.0)], _camera(middle, ANGLE_DEG), SIZE, LEGEND)
    ends = [line[1] for line in lines[0]]
    error_mm = max(LEAST_ERROR_MM, *(float(np.linalg.norm(end - ends[0])) for end in ends))
    size = (round(INSET_SHARE * SIZE[0]), round(INSET_SHARE * SIZE[1]))
    angle_deg = float(np.degrees(2.0 * np.arctan(0.5 * INSET_ERRORS * error_mm / AWAY_MM)))
    near = _camera(np.mean(ends, axis=0), angle_deg)
    lay_in_corner(pixels, _picture(_line_nodes(lines[:1], error_mm / 8.0), near, size))
    write_png(pixels, path)


def _picture(
    nodes: Sequence[Node], camera: Camera, size: tuple[int, int], legend: Legend = ()
) -> np.ndarray:
    """Return (height, width, 3) uint8, with a scale and a legend."""
    height_mm = 2.0 * AWAY_MM * float(np.tan(np.radians(camera.view_angle_deg) / 2.0))
    renderer = vtkRenderer()
    for actor in node_actors(nodes, {}, {}):
        renderer.AddActor(actor)
    light_room(renderer, Shadows.NONE)
    renderer.SetBackground(0.93, 0.94, 0.95)
    rows = [(MARGIN + number * ROW, *row) for number, row in enumerate(reversed(legend))]
    for bottom, _material, text in rows:
        _write(renderer, text, MARGIN + SWATCH[0] + 14, bottom)
    scale = _write(renderer, f"{bar_mm(height_mm):g} mm", size[0] - MARGIN, MARGIN + THICK + 4)
    scale.GetTextProperty().SetJustificationToRight()
    (pixels,) = frames(renderer, [(camera, size)])
    for bottom, material, _text in rows:
        color = np.round(255.0 * np.array(material.color))
        _paint(pixels, MARGIN, bottom + TEXT_SIZE // 2, *SWATCH, color)
    paint_scale(pixels, height_mm)
    return pixels


def _line_nodes(lines: Sequence[tuple[Line, Line, Line]], thickness: float) -> list[Node]:
    return [
        _line_node(f"{material.name}_{number}", line, material, thickness)
        for number, three in enumerate(lines)
        for line, material in zip(three, (PLANNED, SHOWN, PLACED), strict=True)
    ]


def _line_node(name: str, line: Line, material: Material, thickness: float) -> Node:
    """Return a thin cylinder with a ball at its end, RAS in m."""
    start, end = (np.asarray(point) / MM_PER_M for point in line)
    length = float(np.linalg.norm(end - start))
    along = (end - start) / length
    across = np.array(any_perpendicular(vector(along.tolist())))
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([across, np.cross(along, across), along])
    pose[:3, 3] = start
    radius, ball = (thickness * size / MM_PER_M for size in (LINE_MM, BALL_MM))
    shaft = turned(0.0, 0.0, [(radius, 0.0), (radius, length)], material, pose)
    angles = np.linspace(-np.pi / 2, np.pi / 2, 12)
    profile = [(ball * np.cos(a) + 1e-7, length + ball * np.sin(a)) for a in angles]
    return Node(name, (shaft, turned(0.0, 0.0, profile, material, pose)))


def _camera(place: np.ndarray, angle_deg: float) -> Camera:
    position = place + AWAY_MM * FROM / np.linalg.norm(FROM)
    return Camera(position, place, np.array([0.0, 0.0, 1.0]), angle_deg)
