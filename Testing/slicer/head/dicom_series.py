"""Write a DICOM series, for tests: the least that a reader of CT slices needs (PS3.5, PS3.10)."""

import struct

import numpy as np

EXPLICIT_LITTLE_ENDIAN = "1.2.840.10008.1.2.1"
CT_IMAGE_STORAGE = "1.2.840.10008.5.1.4.1.1.2"
LONG = {"OB", "OW", "SQ", "UN", "UT"}


def write_series(folder, values, spacing, series="1.2.3.4", first=(0.0, 0.0, 0.0)):
    """Write (i, j, k) int16 values, axial, one file a slice from below; `first` is LPS mm."""
    folder.mkdir(exist_ok=True)
    for k in range(values.shape[2]):
        position = (first[0], first[1], first[2] + k * spacing[2])
        name = f"{series}-{(k * 7) % values.shape[2]:03d}.dcm"
        (folder / name).write_bytes(slice_file(values[:, :, k], spacing, position, series, k))


def slice_file(values, spacing, position, series, number):
    uid = f"{series}.{number + 1}"
    pixels = np.ascontiguousarray(values.T.astype("<i2")).tobytes()
    meta = b"".join(
        [
            element(0x0002, 0x0001, "OB", b"\0\1"),
            element(0x0002, 0x0002, "UI", CT_IMAGE_STORAGE),
            element(0x0002, 0x0003, "UI", uid),
            element(0x0002, 0x0010, "UI", EXPLICIT_LITTLE_ENDIAN),
            element(0x0002, 0x0012, "UI", "1.2.3"),
        ]
    )
    data = b"".join(
        [
            element(0x0008, 0x0016, "UI", CT_IMAGE_STORAGE),
            element(0x0008, 0x0018, "UI", uid),
            element(0x0008, 0x0060, "CS", "CT"),
            element(0x0018, 0x0050, "DS", f"{spacing[2]:g}"),
            element(0x0020, 0x000D, "UI", "1.2.3.9"),
            element(0x0020, 0x000E, "UI", series),
            element(0x0020, 0x0013, "IS", str(number + 1)),
            element(0x0020, 0x0032, "DS", "\\".join(f"{x:g}" for x in position)),
            element(0x0020, 0x0037, "DS", "1\\0\\0\\0\\1\\0"),
            element(0x0028, 0x0002, "US", 1),
            element(0x0028, 0x0004, "CS", "MONOCHROME2"),
            element(0x0028, 0x0010, "US", values.shape[1]),
            element(0x0028, 0x0011, "US", values.shape[0]),
            element(0x0028, 0x0030, "DS", f"{spacing[1]:g}\\{spacing[0]:g}"),
            element(0x0028, 0x0100, "US", 16),
            element(0x0028, 0x0101, "US", 16),
            element(0x0028, 0x0102, "US", 15),
            element(0x0028, 0x0103, "US", 1),
            element(0x0028, 0x1052, "DS", "0"),
            element(0x0028, 0x1053, "DS", "1"),
            element(0x7FE0, 0x0010, "OW", pixels),
        ]
    )
    return bytes(128) + b"DICM" + element(0x0002, 0x0000, "UL", len(meta)) + meta + data


def element(group, number, kind, value):
    if kind in ("US", "UL"):
        value = struct.pack("<H" if kind == "US" else "<I", value)
    elif isinstance(value, str):
        value = value.encode()
    if len(value) % 2:
        value += b"\0" if kind == "UI" else b" "
    head = struct.pack("<HH", group, number) + kind.encode()
    length = struct.pack("<HI", 0, len(value)) if kind in LONG else struct.pack("<H", len(value))
    return head + length + value
