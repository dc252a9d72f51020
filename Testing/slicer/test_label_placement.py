"""Labels stand beside their points and do not hide each other."""

import numpy as np

from rastrainer_headless.picture_layout import placeLabels

SIZE = (80.0, 28.0)
NOTHING = np.zeros((0, 2))


def test_a_lonely_label_stands_to_the_right_and_up():
    assert placeLabels(np.zeros((1, 2)), np.array([SIZE]), NOTHING, 10.0) == [(1, 1)]


def test_a_label_gives_way_to_what_is_there():
    arrow = np.column_stack([np.linspace(0, 60, 9), np.linspace(0, 30, 9)])
    assert placeLabels(np.zeros((1, 2)), np.array([SIZE]), arrow, 10.0) == [(1, -1)]


def test_neighbors_do_not_cover_each_other():
    anchors = np.array([[0.0, 0.0], [30.0, 5.0], [10.0, 30.0]])
    sides = placeLabels(anchors, np.array([SIZE] * 3), anchors, 10.0)
    boxes = []
    for anchor, side in zip(anchors, sides, strict=True):
        middle = anchor + (10.0 + 0.5 * np.array(SIZE)) * side
        boxes.append((middle - 0.5 * np.array(SIZE), middle + 0.5 * np.array(SIZE)))
    for i, (low, high) in enumerate(boxes):
        for other_low, other_high in boxes[i + 1 :]:
            assert np.any((np.minimum(high, other_high) - np.maximum(low, other_low)) <= 0)
