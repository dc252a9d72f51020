"""Orders of conditions, balanced for position and for what came just before (Williams 1949)."""

from __future__ import annotations


def williams_design(count: int) -> tuple[tuple[int, ...], ...]:
    """Return the rows of a balanced Latin square of conditions 0 … count − 1.

    In all rows together, every condition is as often at every position, and follows every other
    one equally often. An even count needs as many rows, an odd one twice as many: the square and
    its mirror image.
    """
    first = [0]
    low, high = 1, count - 1
    while len(first) < count:
        first.append(low if len(first) % 2 else high)
        low, high = (low + 1, high) if len(first) % 2 == 0 else (low, high - 1)
    square = [tuple((value + row) % count for value in first) for row in range(count)]
    if count % 2:
        square += [row[::-1] for row in square]
    return tuple(square)
