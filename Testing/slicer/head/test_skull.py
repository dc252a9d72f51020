"""The skull of a scan: closed and within the skin, whether bone or an approximation."""

import numpy as np
import pytest

from rastrainer.head.mesh import nearest_on_mesh
from rastrainer.procedure.geometry import bone_ahead
from rastrainer.slicer.head.head_body import HeadSettings
from rastrainer.slicer.head.head_draft import makeDraft
from rastrainer.slicer.head.images_and_skull import BONE_MM, SCALP_MM
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
    assert "an approximation, a shell from 7 to 14 mm below the skin" in draft.method
    depth = depth_mm(draft.skull.vertices[draft.skull.vertices[:, 2] > 0.0], SIZE)
    is_outer = depth < SCALP_MM + BONE_MM / 2
    assert 0.4 < is_outer.mean() < 0.8
    for table, nominal in ((depth[is_outer], SCALP_MM), (depth[~is_outer], SCALP_MM + BONE_MM)):
        assert np.abs(table - nominal).max() < 2.0
        assert abs(np.median(table) - nominal) < 1.0


@of(MRI)
def test_a_line_into_the_skull_of_an_mri_meets_both_tables(draft):
    top = np.array([0.0, 0.0, draft.head.vertices[:, 2].max() + 10.0])
    bone = bone_ahead(draft.skull, top, np.array([0.0, 0.0, -1.0]), 100.0)
    assert bone.outer_mm == pytest.approx(10.0 + SCALP_MM, abs=1.0)
    assert bone.inner_mm - bone.outer_mm == pytest.approx(BONE_MM, abs=1.0)
