"""Write DICOM files for tests: series of slices, and an enhanced file of many frames."""

from __future__ import annotations

import io

import numpy as np
import pydicom
from pydicom.dataset import FileMetaDataset
from pydicom.uid import CTImageStorage, EnhancedMRImageStorage, ExplicitVRLittleEndian, generate_uid

LPS_TO_RAS = np.diag([-1.0, -1.0, 1.0, 1.0])


def write_slices(folder, datasets, prefix="IM"):
    """Write each data set into its own file, not in the order of their places."""
    folder.mkdir(exist_ok=True, parents=True)
    for k, each in enumerate(datasets):
        path = folder / f"{prefix}-{(k * 7) % len(datasets):03d}-{k}.dcm"
        each.save_as(path, enforce_file_format=True)


def slices(values, matrix, series="1.2.3.4", **tags):
    """Return the data sets of (i, j, k) int16 values whose indices `matrix` (4, 4) takes to LPS."""
    return [_slice(values[:, :, k], matrix, series, k, tags) for k in range(values.shape[2])]


def slice_file(values, spacing, position, series, number):
    """Return the bytes of one slice, (i, j) int16."""
    matrix = np.diag([*spacing, 1.0])
    matrix[:3, 3] = np.array(position) - [0.0, 0.0, number * spacing[2]]
    content = io.BytesIO()
    _slice(values, matrix, series, number, {}).save_as(content, enforce_file_format=True)
    return content.getvalue()


def enhanced(values, matrix):
    """Return the data set of an enhanced MRI: all slices as frames of one file, from above."""
    image = _pixels(values[:, :, 0], EnhancedMRImageStorage)
    image.SeriesInstanceUID, image.Modality = "1.2.3.5", "MR"
    image.NumberOfFrames = values.shape[2]
    shared, measures, orientation = (pydicom.Dataset() for _ in range(3))
    spacing = np.linalg.norm(matrix[:3, :3], axis=0)
    measures.PixelSpacing = [spacing[1], spacing[0]]
    orientation.ImageOrientationPatient = _direction(matrix, spacing)
    shared.PixelMeasuresSequence, shared.PlaneOrientationSequence = [measures], [orientation]
    image.SharedFunctionalGroupsSequence = [shared]
    order = range(values.shape[2])[::-1]
    frames = []
    for k in order:
        frame, place = pydicom.Dataset(), pydicom.Dataset()
        place.ImagePositionPatient = _numbers((matrix @ [0, 0, k, 1])[:3])
        frame.PlanePositionSequence = [place]
        frames.append(frame)
    image.PerFrameFunctionalGroupsSequence = frames
    image.PixelData = b"".join(values[:, :, k].T.astype("<i2").tobytes() for k in order)
    return image


def _slice(values, matrix, series, number, tags):
    image = _pixels(values, CTImageStorage)
    image.SOPInstanceUID = f"{series}.{number + 1}"
    image.Modality, image.SeriesInstanceUID, image.InstanceNumber = "CT", series, number + 1
    spacing = np.linalg.norm(matrix[:3, :3], axis=0)
    image.PixelSpacing = _numbers([spacing[1], spacing[0]])
    image.ImageOrientationPatient = _direction(matrix, spacing)
    image.ImagePositionPatient = _numbers((matrix @ [0, 0, number, 1])[:3])
    image.RescaleIntercept, image.RescaleSlope = "0", "1"
    for name, value in tags.items():
        setattr(image, name, value)
    return image


def _pixels(values, kind):
    image = pydicom.Dataset()
    image.file_meta = FileMetaDataset()
    image.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian
    image.SOPClassUID, image.SOPInstanceUID = kind, generate_uid(entropy_srcs=["a head"])
    image.Columns, image.Rows = values.shape
    image.SamplesPerPixel, image.PhotometricInterpretation = 1, "MONOCHROME2"
    image.BitsAllocated, image.BitsStored, image.HighBit = 16, 16, 15
    image.PixelRepresentation = 1
    image.PixelData = np.ascontiguousarray(values.T.astype("<i2")).tobytes()
    return image


def _direction(matrix, spacing):
    return _numbers((matrix[:3, :2] / spacing[:2]).T.ravel())


def _numbers(values):
    return [f"{value:.10g}"[:16] for value in values]
