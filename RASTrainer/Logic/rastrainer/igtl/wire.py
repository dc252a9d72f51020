"""What messages share on the wire: fixed-size names, texts, finite numbers, and the checksum."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rastrainer.errors import InputError

ASCII = 3
UTF8 = 106
"""IANA numbers of the two encodings that are sent."""

_FLOAT32_MAX = 3.4028234663852886e38


def pack_name(name: str, size: int, what: str) -> bytes:
    """Return `name` as printable ASCII of at most `size` bytes; `struct` pads it.

    Raises:
        InputError: too long, or not printable ASCII.
    """
    if len(name) > size or not (name.isascii() and name.isprintable()):
        raise InputError(f"{what} must be printable ASCII of at most {size} characters.")
    return name.encode("ascii")


def unpack_name(field: bytes, keep_bytes: bool = False) -> str:
    """Return the text before the first NUL; non-ASCII characters are replaced.

    With `keep_bytes` it is decoded like `decode_text`.
    """
    name = field.partition(b"\0")[0]
    text = decode_text(name, True) if keep_bytes else name.decode("ascii", "replace")
    return text.rstrip()


def encode_text(text: str) -> tuple[int, bytes]:
    """Return the IANA number of the encoding and the bytes of `text`.

    Raises:
        InputError: the text has a NUL, at which Slicer would truncate it, or a lone surrogate.
    """
    if "\0" in text:
        raise InputError("A text must not contain NUL characters.")
    if text.isascii():
        return ASCII, text.encode("ascii")
    try:
        return UTF8, text.encode("utf-8")
    except UnicodeEncodeError:
        raise InputError("A text must be valid Unicode.") from None


def decode_text(data: bytes, keep_bytes: bool = False) -> str:
    """Return UTF-8 text without the NULs that some peers append.

    The declared encoding is ignored: Slicer declares ASCII for UTF-8. With `keep_bytes`, invalid
    bytes become lone surrogates, from which they can be recovered.

    Raises:
        InputError: not UTF-8, unless `keep_bytes`.
    """
    try:
        return data.decode("utf-8", "surrogateescape" if keep_bytes else "strict").rstrip("\0")
    except UnicodeDecodeError:
        raise InputError("A text must be encoded in UTF-8.") from None


def check_float32(values: Sequence[float], what: str) -> None:
    """Check that every value is a finite 32-bit number.

    Raises:
        InputError: NaN, infinite or beyond what 32 bits hold.
    """
    for value in values:
        # NaN compares as false, too.
        if not -_FLOAT32_MAX <= value <= _FLOAT32_MAX:
            raise InputError(f"{what} must be finite 32-bit numbers.")


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
