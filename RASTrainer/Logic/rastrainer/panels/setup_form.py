"""How the head stands before the robot, as numbers to be changed."""

from __future__ import annotations

from typing import Any

import qt

from rastrainer.head_pose import WIDEST, Perturbation
from rastrainer.protocol import WORLD_LIMIT_MM
from rastrainer.scenario import STAND_DIAMETERS_MM
from rastrainer.scenario_setup import SetUp
from rastrainer.slicer.translation import _

NARROWEST = 60
_USUAL = SetUp()
_MOVED = _USUAL.perturbation
_PLACE, _EXTENT = (-WORLD_LIMIT_MM, WORLD_LIMIT_MM), (1.0, WORLD_LIMIT_MM)
_ROWS = (
    (_("Head's middle, mm:"), "head", _PLACE, _USUAL.head_center),
    (_("Head's turn, °:"), "yaw", (-180.0, 180.0), (_USUAL.head_yaw_deg,)),
    (
        _("Shift in a trial, ± mm:"),
        "shift",
        (0.0, WIDEST.translation_mm),
        (_MOVED.translation_mm,),
    ),
    (_("Turn in a trial, ± °:"), "turn", (0.0, WIDEST.yaw_deg), (_MOVED.yaw_deg,)),
    (_("Tilt in a trial, ± °:"), "tilt", (0.0, WIDEST.tilt_deg), (_MOVED.tilt_deg,)),
    (_("Table's middle, mm:"), "table", _PLACE, _USUAL.table_center),
    (_("Table's size, mm:"), "size", _EXTENT, _USUAL.table_size),
    (_("Stand's diameter, mm:"), "stand", STAND_DIAMETERS_MM, (_USUAL.stand_diameter,)),
    (_("Robot's base, mm:"), "base", _PLACE, _USUAL.robot_base),
)
"""Label, name, lowest and highest, usual values; places are in the table's frame."""


class SetUpForm:
    """The spin boxes of a set-up, in rows of a form; they are called `head0SpinBox` and so on."""

    def __init__(self, parent: Any) -> None:
        """Fill a widget that has no layout yet."""
        layout = qt.QFormLayout(parent)
        self._boxes: dict[str, list[Any]] = {}
        for label, name, limits, usual in _ROWS:
            row = qt.QWidget()
            across = qt.QHBoxLayout(row)
            across.setContentsMargins(0, 0, 0, 0)
            self._boxes[name] = [
                _spinBox(f"{name}{place}SpinBox", limits, value)
                for place, value in enumerate(usual)
            ]
            for box in self._boxes[name]:
                across.addWidget(box)
            layout.addRow(label, row)

    def setUp(self) -> SetUp:
        """Return the set-up that is chosen."""
        values = {name: tuple(box.value for box in boxes) for name, boxes in self._boxes.items()}
        return SetUp(
            head_center=values["head"],
            head_yaw_deg=values["yaw"][0],
            perturbation=Perturbation(*values["shift"], *values["turn"], *values["tilt"]),
            table_center=values["table"],
            table_size=values["size"],
            stand_diameter=values["stand"][0],
            robot_base=values["base"],
        )


def _spinBox(name: str, limits: tuple[float, float], value: float) -> Any:
    box = qt.QDoubleSpinBox()
    box.objectName = name
    box.minimum, box.maximum = limits
    box.decimals = 1
    # Three stand in a row: they are not to be as wide as the widest number they could show.
    box.minimumWidth = NARROWEST
    box.value = value
    return box
