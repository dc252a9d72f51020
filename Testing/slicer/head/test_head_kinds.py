"""MRI and CT of the same head give the same skin; the skull is what it is."""

import numpy as np
import pytest

from rastrainer.slicer.head.extraction import findHead
from rastrainer.slicer.head.head_body import HeadSettings
from rastrainer.slicer.head.head_draft import makeDraft
from rastrainer.slicer.head.volume import Volume
from Testing.slicer.head.phantoms import CT, NOSE, SCALP_MM, depth_mm, phantom

BASE = -30.0
SIZE = 0.75
SETTINGS = HeadSettings(baseMm=BASE)


@pytest.fixture(scope="module")
def ct_draft():
    """A CT on a table, turned in the scanner, with thick slices."""
    scan = phantom(CT, spacing=(1.2, 1.2, 2.0), turn_deg=9.0, noise=15.0, size=SIZE)
    return makeDraft(scan, SETTINGS)


def errors_mm(mesh, size=1.0):
    """Distances of vertices to the skin, away from the base and the nose, (n,)."""
    away = mesh.vertices[mesh.vertices[:, 2] > BASE + 4]
    nose = np.linalg.norm(away - size * NOSE, axis=1) < 20 * size
    return np.abs(depth_mm(away[~nose], size))


def is_one_closed_body(mesh):
    return mesh.is_closed and mesh.euler_characteristic == 2 and len(mesh.triangles) <= 60_000


def test_the_skin_of_a_ct_is_found(ct_draft):
    draft, warnings = ct_draft
    assert not warnings
    assert is_one_closed_body(draft.head)
    errors = errors_mm(draft.head, SIZE)
    assert errors.mean() < 0.5
    assert np.percentile(errors, 95) < 1.0


def test_the_skull_of_a_ct_is_its_bone(ct_draft):
    draft, _ = ct_draft
    assert not draft.is_skull_approximate
    upper = draft.skull.vertices[draft.skull.vertices[:, 2] > 0]
    depth = depth_mm(upper, SIZE)
    outer = depth[depth < SCALP_MM + 3]
    assert len(outer) > 1000
    assert abs(np.median(outer) - SCALP_MM) < 0.7
    assert "bone of the CT" in draft.method


@pytest.mark.soak
def test_thick_slices_give_a_whole_head_and_a_warning():
    # Cut where nobody has chosen a base, its decimated skin has a fin, which must go.
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
