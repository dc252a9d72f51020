"""A rotation as a quaternion, in the order that three.js takes: x, y, z, w."""

from __future__ import annotations

import math
from collections.abc import Sequence


def quaternion(rows: Sequence[Sequence[float]]) -> tuple[float, float, float, float]:
    """Return the unit quaternion (x, y, z, w) of a rotation matrix, given row by row.

    The largest of the four is found first and the others divided by it (Shepperd 1978), so that
    no angle loses digits. A (4, 4) pose is taken for its rotation.
    """
    (xx, xy, xz, *_), (yx, yy, yz, *_), (zx, zy, zz, *_) = rows[:3]
    squares = (1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz, 1 + xx + yy + zz)
    largest = max(range(4), key=squares.__getitem__)
    twice = math.sqrt(squares[largest])
    x, y, z, w = {
        0: lambda: (twice, (xy + yx) / twice, (xz + zx) / twice, (zy - yz) / twice),
        1: lambda: ((xy + yx) / twice, twice, (yz + zy) / twice, (xz - zx) / twice),
        2: lambda: ((xz + zx) / twice, (yz + zy) / twice, twice, (yx - xy) / twice),
        3: lambda: ((zy - yz) / twice, (xz - zx) / twice, (yx - xy) / twice, twice),
    }[largest]()
    return x / 2, y / 2, z / 2, w / 2
