"""The surface match compared with VTK, Open3D and small_gicp: documented and new figures."""

from pathlib import Path

import pytest

from Testing.icp_peers.compare import HEADS, compare, stored, table

PAGE = Path(__file__).with_name("comparison.md")
CLEARLY = 0.01
"""A share of the cost: on coarse triangles, some minima differ by half a percent."""


def test_the_documentation_has_the_table_of_what_was_compared():
    assert table() in PAGE.read_text(encoding="utf-8")


def test_no_stored_match_is_wrong_or_clearly_worse_than_that_of_a_peer():
    for one in stored():
        assert one.error_mm < 3.0, one
        assert min(one.cost_off_mm2, one.next_off_mm2) > -CLEARLY * one.cost_mm2, one


@pytest.mark.soak
@pytest.mark.parametrize("head", HEADS)
def test_no_peer_finds_a_clearly_lower_minimum_than_a_match_on_any_head(head):
    for one in compare(head, range(500, 503)):
        assert one.error_mm < 3.0, one
        assert min(one.cost_off_mm2, one.next_off_mm2) > -CLEARLY * one.cost_mm2, one
