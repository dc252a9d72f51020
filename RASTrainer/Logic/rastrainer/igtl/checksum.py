"""The checksum of a message body: CRC-64 ECMA-182, not reflected, starting at zero."""

from __future__ import annotations

from collections.abc import Callable

_POLYNOMIAL = 0x42F0E1EBA9EA3693
_MASK = 0xFFFFFFFFFFFFFFFF


def _remainder(byte: int) -> int:
    value = byte << 56
    for _ in range(8):
        value = ((value << 1) ^ (_POLYNOMIAL if value >> 63 else 0)) & _MASK
    return value


_TABLE = tuple(_remainder(byte) for byte in range(256))


def plain_crc64(data: bytes) -> int:
    """Return the CRC-64 of `data` in plain Python, about ten megabytes a second."""
    value = 0
    for byte in data:
        value = (value << 8 & _MASK) ^ _TABLE[value >> 56 ^ byte]
    return value


crc64: Callable[[bytes], int]
try:
    from fastcrc.crc64 import ecma_182 as crc64
except ImportError:  # Slicer's Python has no fastcrc, and no user should have to install it there.
    crc64 = plain_crc64
