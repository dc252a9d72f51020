"""The draft of a head from MRI and from CT: the same skin, what its method states, its skull."""

import numpy as np
import pytest

from rastrainer.scenario.scenario import SkullKind
from rastrainer.slicer.head.extraction import findHead
from rastrainer.slicer.head.head_draft import BONE_MM, SCALP_MM, makeDraft
from rastrainer.slicer.head.volume import HeadSettings, Volume
from Testing.slicer.head import phantoms
from Testing.slicer.head.phantoms import CT, MRI, NOSE, depth_mm, phantom

BASE = -30.0
SIZE = 0.75
SETTINGS = HeadSettings(baseMm=BASE)


@pytest.fixture(scope="module")
def mri():
    """The draft of an MRI, with its images."""
    return makeDraft(phantom(MRI, spacing=(2, 2, 2), size=SIZE), SETTINGS)


@pytest.fixture(scope="module")
def ct():
    """The draft of a CT on a table, turned in the scanner, with thick slices; without images."""
    scan = phantom(CT, spacing=(1.2, 1.2, 2.0), turn_deg=9.0, noise=15.0, size=SIZE)
    return makeDraft(scan, SETTINGS, hasVolume=False)


@pytest.fixture(params=["mri", "ct"])
def draft(request):
    return request.getfixturevalue(request.param)[0]


def errors_mm(mesh, size=1.0):
    """Distances of vertices to the skin, away from the base and the nose, (n,)."""
    away = mesh.vertices[mesh.vertices[:, 2] > BASE + 4]
    nose = np.linalg.norm(away - size * NOSE, axis=1) < 20 * size
    return np.abs(depth_mm(away[~nose], size))


def is_one_closed_body(mesh):
    return mesh.is_closed and mesh.euler_characteristic == 2 and len(mesh.triangles) <= 60_000


def test_the_skin_of_a_ct_is_found(ct):
    draft, warnings = ct
    assert not warnings
    assert is_one_closed_body(draft.head)
    errors = errors_mm(draft.head, SIZE)
    assert errors.mean() < 0.5
    assert np.percentile(errors, 95) < 1.0


@pytest.mark.soak
def test_thick_slices_give_a_whole_head_and_a_warning():
    # Cut where no base was chosen, its decimated skin has a fin, which must be removed.
    scan = phantom(spacing=(1.0, 1.0, 5.0))
    draft, warnings = makeDraft(scan, HeadSettings(), hasSkull=False)
    assert "5.0 mm apart" in warnings[0]
    assert is_one_closed_body(draft.head)
    assert errors_mm(draft.head).mean() < 1.0


def test_a_scan_that_continues_below_the_neck_is_cut_200_mm_below_the_crown():
    ijk = np.indices((24, 24, 90)).reshape(3, -1).T * 3.0
    crown = np.linalg.norm(ijk - [36.0, 36.0, 220.0], axis=1) < 25.0
    neck = (np.hypot(*(ijk[:, :2] - 36.0).T) < 14.0) & (ijk[:, 2] < 220.0)
    values = np.where(crown | neck, 100.0, 0.0).reshape(24, 24, 90).astype(np.float32)
    scan = Volume(values, np.diag([3.0, 3.0, 3.0, 1.0]))
    found = findHead(scan, HeadSettings(), lambda _step, _share: None)
    assert found.baseMm == pytest.approx(245.0 - 200.0, abs=3.0)


# The skull


def test_the_skull_is_closed_within_the_skin_and_ends_at_the_heads_base(draft):
    assert draft.skull.is_closed
    heights = draft.skull.vertices[:, 2]
    assert abs(heights.min() - BASE) < 1.0
    above = draft.skull.vertices[heights > BASE + SCALP_MM]
    assert depth_mm(above, SIZE).min() > 3.0
    assert draft.head.tree.nearest(above[::20]).distances.min() > 3.0


def test_the_skull_of_a_ct_is_its_bone(ct):
    draft, _warnings = ct
    assert draft.volume is None
    assert draft.skull_kind is SkullKind.BONE
    upper = draft.skull.vertices[draft.skull.vertices[:, 2] > 0]
    depth = depth_mm(upper, SIZE)
    outer = depth[depth < phantoms.SCALP_MM + 3]
    assert len(outer) > 1000
    assert abs(np.median(outer) - phantoms.SCALP_MM) < 0.7
    assert "bone of the CT" in draft.method


def test_the_skull_of_an_mri_is_one_body_as_deep_below_the_skin_as_its_method_states(mri):
    draft, _warnings = mri
    assert "Images: MRI, 1 mm" in draft.method
    assert draft.volume is not None
    assert draft.skull_kind is SkullKind.APPROXIMATION
    assert draft.skull.euler_characteristic == 2
    assert "an approximation, a shell from 7 to 14 mm below the skin" in draft.method
    depth = depth_mm(draft.skull.vertices[draft.skull.vertices[:, 2] > 0.0], SIZE)
    is_outer = depth < SCALP_MM + BONE_MM / 2
    assert 0.4 < is_outer.mean() < 0.8
    for table, nominal in ((depth[is_outer], SCALP_MM), (depth[~is_outer], SCALP_MM + BONE_MM)):
        assert np.abs(table - nominal).max() < 2.0
        assert abs(np.median(table) - nominal) < 1.0
