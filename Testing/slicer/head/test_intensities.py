"""Values that a program has put into an image are not tissue; CT differs from MRI."""

import numpy as np
import pytest
from scipy import ndimage
from scipy.spatial.transform import Rotation

from rastrainer.slicer.head.extraction import findHead
from rastrainer.slicer.head.head_draft import imageOf
from rastrainer.slicer.head.intensities import cleaned, isHounsfield, skullWarnings
from rastrainer.slicer.head.volume import HeadSettings, Volume
from Testing.slicer.head.phantoms import CT, MRI, SCALP_MM, SKULL_MM, phantom, voxel_depths

SIZE, SMALL = 0.45, 0.35
"""Size of the phantom's head: the least in which a CT is recognized, and an MRI."""
COARSE = (4.0, 4.0, 4.0)
LARGE_MRI = {kind: 10.0 * value for kind, value in MRI.items()}


def scan(kinds=MRI, **options):
    """Return a coarse head, whose values are magnitudes if it is an MRI."""
    volume = phantom(kinds, **{"spacing": COARSE, "size": SIZE, "noise": 1.0} | options)
    return volume if kinds["air"] < 0 else Volume(np.abs(volume.values), volume.ijkToRas)


def depths(volume, size=SIZE):
    """Return how deep below the skin each voxel is, (i, j, k), mm."""
    return voxel_depths(volume.values, volume.ijkToRas, size)


def padded(volume, fill, count=6):
    """Return a volume with a fill on all sides but the lowest."""
    matrix = volume.ijkToRas.copy()
    matrix[:3, 3] -= matrix[:3, :3] @ [count, count, 0]
    around = [(count, count), (count, count), (0, count)]
    return Volume(np.pad(volume.values, around, constant_values=fill), matrix)


def resampled(volume, fill):
    """Return a volume that was turned, with a fill where it then has nothing."""
    turn = Rotation.from_euler("xz", [8.0, 25.0], degrees=True).as_matrix()
    middle = (np.array(volume.values.shape) - 1) / 2.0
    values = ndimage.affine_transform(
        volume.values, turn, middle - turn @ middle, order=1, cval=fill
    )
    return Volume(values, volume.ijkToRas)


def stored(volume):
    """Return a CT as the scanner stores it, without the rescale intercept."""
    return Volume(np.maximum(volume.values + 1024.0, 0.0), volume.ijkToRas)


@pytest.mark.parametrize(
    "make",
    [
        pytest.param(lambda: scan(CT), id="as it should be"),
        pytest.param(lambda: resampled(scan(CT), 0.0), id="resampled, filled with 0"),
        pytest.param(lambda: padded(scan(CT), 0.0), id="padded with 0"),
        pytest.param(lambda: resampled(scan(CT), -3024.0), id="resampled, filled with −3024"),
        pytest.param(lambda: stored(scan(CT)), id="without rescale intercept"),
        pytest.param(lambda: padded(stored(scan(CT)), -2000.0), id="without it, and padded"),
    ],
)
def test_a_ct_is_one_of_air_around_a_head_whatever_was_put_around_it(make):
    values = cleaned(make())[0].values
    assert isHounsfield(values)
    assert np.mean(values < -900.0) > 0.3
    # No block of a fill: all tissue belongs to one head, away from the image's upper corners.
    assert (values[:3, :3, -3:] < -900.0).all()
    assert (values[-3:, -3:, -3:] < -900.0).all()
    middle = tuple(n // 2 for n in values.shape)
    assert values[middle] == pytest.approx(CT["brain"], abs=20.0)


@pytest.mark.parametrize(
    ("kinds", "fill", "put"),
    [
        (MRI, -1000.0, padded),
        (LARGE_MRI, -1000.0, resampled),
        (MRI, -2000.0, resampled),
        (LARGE_MRI, -32768.0, padded),
    ],
)
def test_an_mri_with_a_fill_is_no_ct_and_has_air_in_its_place(kinds, fill, put):
    values = cleaned(put(scan(kinds), fill))[0].values
    assert not isHounsfield(values)
    low, high = np.quantile(values, (0.0, 0.5))
    assert low > -0.01 * kinds["scalp"]
    assert high < 0.1 * kinds["scalp"]


def test_a_ct_without_its_intercept_is_used_with_a_warning():
    _volume, offset, warnings = cleaned(stored(scan(CT)))
    assert offset == -1024.0
    assert "without its rescale intercept" in warnings[0]


def normalized(volume):
    """Return a volume with a mean of 0 and a deviation of 1 in its head, and 0 around it."""
    inside = depths(volume, SMALL) > 0
    values = volume.values - volume.values[inside].mean()
    values /= volume.values[inside].std()
    return Volume(np.where(inside, values, 0.0), volume.ijkToRas)


def with_odd(volume, count, value):
    """Return a volume in which a few voxels have another value."""
    places = np.random.default_rng(5).integers(0, volume.values.shape, (count, 3))
    values = volume.values.copy()
    values[tuple(places.T)] = value
    return Volume(values, volume.ijkToRas)


@pytest.mark.parametrize(
    "change",
    [
        pytest.param(lambda mri: with_odd(mri, 9, -32000.0), id="wrapped to negatives"),
        pytest.param(normalized, id="normalized within a mask"),
    ],
)
def test_tissue_keeps_its_contrast_and_the_skin_its_place(change):
    volume = cleaned(change(scan(LARGE_MRI, size=SMALL)))[0]
    found = findHead(volume, HeadSettings(), lambda _step, _share: None)
    images, _sentence = imageOf(volume, found)
    depth = depths(Volume(images.values, images.ijk_to_ras), SMALL)
    tissue = images.values[depth > 1.0]
    assert np.ptp(np.quantile(tissue.astype(float), [0.1, 0.98])) > 40.0
    body = Volume(found.body, np.eye(4))
    body.ijkToRas[:3, 3] = found.origin
    above = np.arange(found.body.shape[2]) + found.origin[2] > 0.0
    depth = depths(body, SMALL)
    assert np.mean((found.body != (depth > 0.0))[(np.abs(depth) > 4.0) & above]) < 0.002


def test_a_brain_without_its_skull_is_used_with_a_warning_only():
    whole = phantom(spacing=(3.0, 3.0, 3.0), size=0.6)
    brain = depths(whole, 0.6) > SCALP_MM + SKULL_MM
    stripped = Volume(np.where(brain, whole.values, 0.0).astype(np.float32), whole.ijkToRas)
    for volume, warned in ((whole, False), (stripped, True)):
        found = findHead(volume, HeadSettings(), lambda _step, _share: None)
        warnings = skullWarnings(volume, found)
        assert any("No skull is seen" in warning for warning in warnings) == warned
