"""The legend and the scale of a picture."""

import numpy as np
import pytest

from rastrainer_simulator.rendering.procedure_picture import INK, bar_mm, paint_scale


@pytest.mark.parametrize(
    ("height_mm", "bar"), [(194.0, 20.0), (4.1, 1.0), (1.0, 0.2), (20.0, 5.0), (0.9, 0.2)]
)
def test_a_scale_is_a_round_number_of_millimeters_at_most_a_quarter_of_the_height(height_mm, bar):
    assert bar_mm(height_mm) == pytest.approx(bar)


def test_the_bar_is_as_long_as_it_says():
    pixels = np.full((400, 640, 3), 255, dtype=np.uint8)
    paint_scale(pixels, 80.0)
    is_ink = (pixels == INK).all(axis=2)
    assert is_ink.any(axis=0).sum() == 20.0 / 80.0 * 400
