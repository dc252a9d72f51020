"""Journals without waiting for the disk: what a killed process has written stays all the same."""

from unittest import mock

import pytest


@pytest.fixture(scope="module", autouse=True)
def _no_sync():
    with mock.patch("os.fsync"):
        yield
