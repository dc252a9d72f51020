import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer_simulator.desktop.inbox import read_parts
from rastrainer_simulator.scene.nodes import SKIN, TIP_FREE
from Testing.simulator.desktop.conftest import BODIES


def test_parts_know_their_body_their_nodes_and_their_finish(glb):
    parts = {part.nodes[0]: part for part in read_parts(glb, BODIES)}
    assert parts["tip_marker"].body == "tool"
    assert parts["skin"].body == parts["fiducial_2"].body == "head"
    assert parts["room"].body == ""
    assert "head" in parts["fiducial_2"].nodes
    np.testing.assert_allclose(parts["skin"].finish.color, SKIN.linear_color, atol=0.003)
    np.testing.assert_allclose(parts["tip_marker"].finish.glow, TIP_FREE.linear_color, atol=0.003)


def test_static_parts_are_in_the_robots_frame_with_z_up(glb):
    room = next(part for part in read_parts(glb, BODIES) if part.nodes[0] == "room")
    np.testing.assert_allclose(room.vertices.min(axis=0), [-3, 0.5, -3], atol=1e-5)
    np.testing.assert_allclose(room.vertices.max(axis=0), [3, 0.6, 3], atol=1e-5)


@pytest.mark.parametrize("content", [b"", b"glTF", b"\0" * 1000, b"{}"])
def test_a_file_that_is_not_a_scene_is_refused_in_one_sentence(content):
    with pytest.raises(InputError, match=r"^The scene .* cannot be read"):
        read_parts(content, BODIES)


def test_a_damaged_scene_is_refused_in_one_sentence(glb):
    with pytest.raises(InputError, match="cannot be read"):
        read_parts(glb[: len(glb) // 2], BODIES)


def test_a_scene_without_the_robot_is_refused(glb):
    with pytest.raises(InputError, match="the robot is not in it"):
        read_parts(glb, ("link_0",))
