"""What a procedure adds to the scene: guide, drill and electrode at the tool, and no-go structures.

All are hidden until a view shows them. Lengths in m.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rastrainer.procedure.plan import Procedure, read_no_go_mesh
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.scene.nodes import AXIS, DRILL, ELECTRODE, GUIDE, NO_GO, Node, no_go_name
from rastrainer_simulator.scene.surfaces import shaded, turned

PLAN = "plan"
SLEEVE_LENGTH, SLEEVE_RADIUS, MOUTH_RADIUS = 0.075, 0.0065, 0.0035
AXIS_LENGTH, AXIS_RADIUS = 0.2, 0.00035
DRILL_RADIUS, ELECTRODE_RADIUS = 0.0016, 0.0011
"""As they are drawn; an electrode is mostly thinner, and would hardly be seen."""


def instrument_nodes() -> tuple[Node, ...]:
    """Return what the tool holds in a procedure; its frame's origin is the tip, z is the axis.

    `drill` and `electrode` are 1 m long: a view scales them along z by how far they are fed.
    """
    sleeve = [
        (SLEEVE_RADIUS, -SLEEVE_LENGTH),
        (SLEEVE_RADIUS, -0.2 * SLEEVE_LENGTH),
        (MOUTH_RADIUS, 0.0),
    ]
    axis = [(AXIS_RADIUS, 0.0), (AXIS_RADIUS, AXIS_LENGTH)]
    drill = [(DRILL_RADIUS, 0.0), (DRILL_RADIUS, 1.0)]
    electrode = [(ELECTRODE_RADIUS, 0.0), (ELECTRODE_RADIUS, 1.0)]
    made = (
        ("guide", sleeve, GUIDE),
        ("axis", axis, AXIS),
        ("drill", drill, DRILL),
        ("electrode", electrode, ELECTRODE),
    )
    return tuple(
        Node(name, (turned(0.0, 0.0, profile, material),), is_hidden=True)
        for name, profile, material in made
    )


def plan_node(procedures: Sequence[Procedure]) -> Node:
    """Return the node that the stream puts where a registration has the MRI: RAS, but in m.

    Its children are the no-go structures of all procedures, one for each file.

    Raises:
        InputError: a mesh cannot be used.
    """
    files = sorted({each.mesh for procedure in procedures for each in procedure.no_go})
    return Node(PLAN, children=tuple(_no_go_node(path) for path in files))


def _no_go_node(path: Path) -> Node:
    mesh = read_no_go_mesh(path)
    surface = shaded(mesh.vertices / MM_PER_M, mesh.triangles, NO_GO)
    return Node(no_go_name(path), (surface,), is_hidden=True)
