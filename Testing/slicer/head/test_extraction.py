"""The head's extraction on a phantom with a known skin, and the morphology of its voxels."""

import numpy as np
import pytest
from scipy import ndimage
from scipy.spatial.transform import Rotation

from rastrainer.slicer.head import mask
from rastrainer.slicer.head.extraction import findHead, skinOf
from rastrainer.slicer.head.mask import carved
from rastrainer.slicer.head.surface import cutFlat, decimated, meshOf, smoothed, surfaceOf
from rastrainer.slicer.head.volume import HeadSettings, Volume, onRasGrid
from rastrainer.work_progress import no_progress
from Testing.slicer.head.phantoms import DOUBLE_OBLIQUE, SAGITTAL, depth_mm

SEMI_AXES = np.array([33.0, 38.0, 36.0])
CENTER = np.array([4.0, -7.0, 12.0])
LOWEST = -14.0


def phantom(ijk_to_ras, shape):
    """T1-like values: skin, dark skull, brain, an airway open to the front, a ring for an ear."""
    ijk = np.indices(shape).reshape(3, -1).T
    ras = ijk @ ijk_to_ras[:3, :3].T + ijk_to_ras[:3, 3]
    offset = ras - CENTER
    radius = np.linalg.norm(offset / SEMI_AXES, axis=1)
    values = np.clip((1 - radius) * SEMI_AXES.mean() + 0.5, 0, 1) * 90.0
    values[(radius < 0.88) & (radius > 0.78)] = 8.0
    airway = (np.hypot(offset[:, 0], offset[:, 2] + 10) < 2.5) & (offset[:, 1] > 0)
    values[airway] = 0.0
    ring = np.hypot(offset[:, 1], offset[:, 2]) - 6.0
    ear = (np.hypot(ring, offset[:, 0] - SEMI_AXES[0] - 3.0) < 2.5) & (offset[:, 0] > 0)
    values[ear] = 90.0
    return Volume(values.reshape(shape).astype(np.float32), ijk_to_ras)


def upright(spacing, shape):
    """Return the phantom in the middle of a grid along RAS, whose lowest slice is at LOWEST."""
    matrix = np.diag([spacing, spacing, spacing, 1.0])
    matrix[:2, 3] = CENTER[:2] - spacing * (np.array(shape[:2]) - 1) / 2
    matrix[2, 3] = LOWEST
    return phantom(matrix, shape)


def stored_along(directions, spacing):
    """Return the phantom on a grid whose axes are columns (3, 3), its lowest slice at LOWEST."""
    shape = np.ceil(np.abs(directions).T @ [110.0, 116.0, 75.0] / spacing).astype(int)
    matrix = np.eye(4)
    matrix[:3, :3] = directions @ np.diag(spacing)
    upright = np.abs(directions[2]).argmax()
    lowest_slice = (shape - 1) / 2
    lowest_slice[upright] = 0 if directions[2, upright] > 0 else shape[upright] - 1
    matrix[:3, 3] = [*CENTER[:2], LOWEST] - matrix[:3, :3] @ lowest_slice
    return phantom(matrix, tuple(shape))


def skin_errors(mesh, above):
    """Distances of the vertices to the ellipsoid, without the base, the airway and the ear."""
    offset = mesh.vertices - CENTER
    radius = np.linalg.norm(offset / SEMI_AXES, axis=1)
    gradient = np.linalg.norm(offset / SEMI_AXES**2, axis=1) / np.maximum(radius, 1e-9)
    base = mesh.vertices[:, 2] < above
    airway = (np.hypot(offset[:, 0], offset[:, 2] + 10) < 8) & (offset[:, 1] > 0)
    ear = (offset[:, 0] > 0) & (np.hypot(offset[:, 1], offset[:, 2]) < 16)
    return np.abs((radius - 1) / gradient)[~(base | airway | ear)]


def skin_in(volume):
    """Return the surface of the head that is found in a volume."""
    settings = HeadSettings(openingMm=8)
    return skinOf(findHead(volume, settings, no_progress), no_progress)


@pytest.mark.parametrize(
    ("directions", "spacing"),
    [
        pytest.param(np.diag([-1.0, -1.0, 1.0]), (1.5, 1.8, 2.5), id="LPS, anisotropic"),
        pytest.param(SAGITTAL, (1.8, 1.8, 2.2), id="stored slice by slice from the left"),
    ],
)
def test_a_scan_is_laid_on_a_grid_along_ras_however_it_is_stored(directions, spacing):
    grid = onRasGrid(stored_along(directions, spacing), 2.0)
    truth = phantom(grid.ijkToRas, grid.values.shape)
    # A flipped axis would be worse than 0.95.
    assert np.corrcoef(grid.values.ravel(), truth.values.ravel())[0, 1] > 0.965


def test_the_skin_is_found_in_a_double_oblique_scan():
    mesh = skin_in(stored_along(DOUBLE_OBLIQUE, (1.5, 1.5, 1.5)))
    # Below, the neck continues straight where the tilted lowest slice omits some of it.
    errors = skin_errors(mesh, above=LOWEST + 14.0)
    assert len(errors) > 10_000
    assert errors.mean() < 0.5
    assert np.percentile(errors, 95) < 1.0
    assert mesh.is_closed
    assert mesh.euler_characteristic == 2
    assert mesh.vertices[:, 2].min() == pytest.approx(LOWEST + 1.0, abs=0.5)


@pytest.mark.parametrize("seed", range(3))
def test_a_head_turned_by_up_to_15_degrees_is_cut_flat_and_closed_at_any_height(seed):
    chance = np.random.default_rng(seed)
    turn = Rotation.from_euler("xyz", chance.uniform(-15.0, 15.0, 3), degrees=True).as_matrix()
    ras = (np.indices((41, 51, 44)).reshape(3, -1).T * 5.0 - [100.0, 125.0, 90.0]) @ turn
    level = np.clip(depth_mm(ras).reshape(41, 51, 44) / 5.0, -1.0, 1.0)
    skin = meshOf(decimated(smoothed(surfaceOf(level, np.zeros(3), 5.0)), 3000, 0.0))
    lowest, top = skin.vertices[:, 2].min(), skin.vertices[:, 2].max()
    for height in chance.uniform(lowest + 1.0, top - 5.0, 8):
        cut = cutFlat(skin, height)
        assert cut.is_closed
        assert cut.euler_characteristic == 2
        assert cut.vertices[:, 2].min() == pytest.approx(height, abs=1e-4)
        base = cut.vertices[cut.triangles][
            (cut.vertices[cut.triangles][:, :, 2] < height + 1e-3).all(axis=1)
        ]
        crosses = np.cross(base[:, 1] - base[:, 0], base[:, 2] - base[:, 0])
        assert (crosses[:, 2] <= 1e-3).all()


def test_a_nose_cut_off_by_the_image_ends_rounded_a_few_millimeters_beyond_it():
    volume = upright(1.0, (80, 60, 60))
    edge = volume.ijkToRas[1, 3] + 60 - 1
    mesh = skin_in(volume)
    assert edge + 2 < mesh.vertices[:, 1].max() < edge + 10
    assert mesh.euler_characteristic == 2


BODY = ndimage.gaussian_filter(np.random.default_rng(2).normal(size=(34, 40, 28)), 2.0) > -0.02


@pytest.mark.parametrize("body", [BODY, BODY.transpose(2, 0, 1)], ids=["C order", "transposed"])
def test_depths_are_exact_within_the_requested_distance(body):
    below = np.pad(body, [(0, 0), (0, 0), (9, 0)], mode="edge")
    exact = ndimage.distance_transform_edt(below)[:, :, 9:]
    depth = mask.depthInside(body, 4.0)
    assert (exact > 4.0).any()
    assert np.allclose(depth[exact <= 4.0], exact[exact <= 4.0], atol=1e-5)
    assert (depth[exact > 4.0] > 4.0).all()


def test_a_closing_fills_whatever_no_ball_outside_can_reach():
    closed = mask.closedByBall(BODY, 3.0)
    padded = np.pad(BODY, [(9, 9), (9, 9), (0, 9)])
    padded = np.pad(padded, [(0, 0), (0, 0), (9, 0)], mode="edge")
    centers = ndimage.distance_transform_edt(~padded) > 3.0
    reached = ndimage.distance_transform_edt(~centers) <= 3.0
    assert np.array_equal(closed, ~reached[9:-9, 9:-9, 9:-9])
    assert closed.sum() > BODY.sum()


def ball(radius, size=31):
    grid = np.indices((size,) * 3) - size // 2
    return np.sqrt((grid**2).sum(axis=0)) <= radius


def euler_characteristic(body):
    return meshOf(surfaceOf(np.where(body, 1.0, -1.0), np.zeros(3), 1.0)).euler_characteristic


def with_tunnel(width):
    body = ball(11)
    body[:, 15 - width : 16 + width, 15 - width : 16 + width] = False
    return body


@pytest.mark.parametrize("width", [0, 3])
def test_a_tunnel_is_closed_by_one_thin_membrane(width):
    wanted = with_tunnel(width)
    assert euler_characteristic(wanted) == 0
    result = carved(ball(11), wanted)
    assert euler_characteristic(result) == 2
    membrane = result & ~wanted
    assert (2 * width + 1) ** 2 <= membrane.sum() <= 2 * (2 * width + 1) ** 2
    assert not (wanted & ~result).any()


def test_noise_never_leaves_a_tunnel():
    rng = np.random.default_rng(5)
    rough = ndimage.gaussian_filter(rng.normal(size=(31, 31, 31)), 1.2)
    wanted = ball(10) & (rough > -0.05)
    wanted[15, 15, 15] = True
    labels, _ = ndimage.label(wanted)
    wanted = labels == np.bincount(labels.ravel())[1:].argmax() + 1
    assert euler_characteristic(wanted) < 0
    assert euler_characteristic(carved(ball(11), wanted)) == 2
