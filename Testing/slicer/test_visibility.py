"""Poses are rendered only if someone may see them."""

import pytest
import slicer


@pytest.mark.parametrize(
    ("layout", "is_entered", "in_slices", "is_seen"),
    [
        ("FourUpView", True, False, True),
        ("FourUpView", False, False, True),
        ("OneUp3DView", False, False, True),
        ("OneUp3DView", False, True, True),
        ("OneUpRedSliceView", True, False, True),
        ("OneUpRedSliceView", False, False, False),
        ("OneUpRedSliceView", False, True, True),
        ("OneUpPlotView", False, True, False),
        ("OneUpPlotView", True, False, True),
    ],
)
def test_visibility_depends_on_the_layout_and_on_the_module(
    host, layout, is_entered, in_slices, is_seen
):
    from rastrainer.sections.application import isAnythingVisible

    number = getattr(slicer.vtkMRMLLayoutNode, f"SlicerLayout{layout}")
    slicer.app.layoutManager().setLayout(number)
    assert isAnythingVisible(is_entered, in_slices) is is_seen
    host.minimize()
    assert not isAnythingVisible(is_entered, in_slices)
    host.minimize(False)
    assert isAnythingVisible(is_entered, in_slices) is is_seen
