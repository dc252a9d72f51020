"""Picture the default scenario: for lists, and its six tasks from four sides.

python assets/scenarios/make_preview.py        writes colin27/preview.png and colin27-tasks.png
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from vtkmodules.vtkRenderingCore import vtkRenderer

from rastrainer.head.mesh import read_head_mesh
from rastrainer.scenario.scenario import PREVIEW_NAME, Camera, load_scenario
from rastrainer_simulator.rendering.lighting import Shadows, light_room
from rastrainer_simulator.rendering.picture import draw_preview, frames, node_actors
from rastrainer_simulator.scene.scene_glb import head_node

FOLDER = Path(__file__).parent / "colin27"
SIDES = {
    "front": (0.1, 1, 0.5),
    "right": (1, 0.1, 0.35),
    "left": (-1, 0.1, 0.35),
    "back": (0, -1, 0.4),
}
AWAY_MM, ANGLE_DEG = 560.0, 24.0
TILE = (300, 270)


def main() -> None:
    scenario = load_scenario(FOLDER)
    head = read_head_mesh(scenario.head)
    draw_preview(FOLDER / PREVIEW_NAME, scenario, head)
    up = np.array([0.0, 0.0, 1.0])
    center = head.centroid + 10.0 * up
    size = len(scenario.tasks) * TILE[0], len(SIDES) * TILE[1]
    figure = Figure((size[0] / 100, size[1] / 100), dpi=100)
    tiles = figure.subplots(len(SIDES), len(scenario.tasks))
    for task, column in zip(scenario.tasks, tiles.T, strict=True):
        renderer = vtkRenderer()
        renderer.SetBackground(0.96, 0.97, 0.98)
        light_room(renderer, Shadows.NONE)
        for actor in node_actors([head_node(head, task)], {}, {}):
            renderer.AddActor(actor)
        eyes = (center + AWAY_MM * np.array(side) / np.linalg.norm(side) for side in SIDES.values())
        shots = ((Camera(eye, center, up, ANGLE_DEG), TILE) for eye in eyes)
        for tile, side, pixels in zip(column, SIDES, frames(renderer, shots), strict=True):
            tile.imshow(pixels, aspect="auto")
            tile.text(8, TILE[1] - 10, f"{task.title}, {side}")
            tile.axis("off")
    figure.subplots_adjust(0, 0, 1, 1, 0, 0)
    figure.savefig(FOLDER.parent / "colin27-tasks.png")


if __name__ == "__main__":
    main()
