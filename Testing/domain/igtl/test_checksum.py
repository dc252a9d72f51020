"""The checksum: the published check value, and the plain Python as good as the compiled one."""

from __future__ import annotations

import random

import fastcrc
import pytest

from rastrainer.igtl.checksum import crc64, plain_crc64


@pytest.mark.parametrize("checksum", [crc64, plain_crc64])
def test_checksum_gives_the_check_value_of_crc_64_ecma_182(checksum):
    assert checksum(b"123456789") == 0x6C40DF5F0B497347


@pytest.mark.parametrize("checksum", [crc64, plain_crc64])
def test_checksum_of_nothing_is_zero(checksum):
    assert checksum(b"") == 0


def test_plain_python_equals_fastcrc_on_random_bodies():
    generator = random.Random(1)
    for length in [1, 2, 7, 8, 9, 48, 255, 2098, 65_537]:
        body = generator.randbytes(length)
        assert plain_crc64(body) == fastcrc.crc64.ecma_182(body)


def test_fastcrc_is_used_where_it_is_installed():
    assert crc64 is fastcrc.crc64.ecma_182
