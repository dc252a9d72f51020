"""The skull of a scan: closed and within the skin, whether bone or an approximation."""

import numpy as np
import pytest

from rastrainer.head.surface_queries import nearest_on_mesh
from rastrainer.slicer.head.head_body import HeadSettings
from rastrainer.slicer.head.head_draft import makeDraft
from rastrainer.slicer.head.images_and_skull import SCALP_MM
from Testing.slicer.head.phantoms import CT, MRI, depth_mm, phantom

BASE = -30.0
SIZE = 0.75


@pytest.fixture(scope="module")
def draft(request):
    """The head in a phantom, with its skull."""
    return makeDraft(
        phantom(request.param, spacing=(2, 2, 2), size=SIZE), HeadSettings(baseMm=BASE)
    )[0]


def of(*kinds):
    """Give a test the drafts of these kinds of scans."""
    names = ["CT" if kind is CT else "MRI" for kind in kinds]
    return pytest.mark.parametrize("draft", kinds, indirect=True, ids=names)


@of(MRI, CT)
def test_it_is_closed_within_the_skin_and_ends_at_the_heads_base(draft):
    assert draft.skull.is_closed
    heights = draft.skull.vertices[:, 2]
    assert abs(heights.min() - BASE) < 1.0
    above = draft.skull.vertices[heights > BASE + SCALP_MM]
    assert depth_mm(above, SIZE).min() > 3.0
    assert min(nearest_on_mesh(draft.head, point).distance for point in above[::50]) > 3.0


@of(MRI)
def test_the_skull_of_an_mri_is_one_body_as_deep_below_the_skin_as_its_method_states(draft):
    assert draft.is_skull_approximate
    assert draft.skull.euler_characteristic == 2
    assert "an approximation, the skin moved inward by 7 mm" in draft.method
    depth = depth_mm(draft.skull.vertices[draft.skull.vertices[:, 2] > 0.0], SIZE)
    assert np.abs(depth - SCALP_MM).max() < 2.0
    assert abs(np.median(depth) - SCALP_MM) < 1.0
