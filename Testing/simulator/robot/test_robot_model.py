import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.robot.model import load_robot

URDF = asset_path("robots", "iiwa7", "iiwa7.urdf")


@pytest.fixture
def changed(tmp_path):
    """Write the robot's URDF with one change and return its path."""

    def write(old: str, new: str, count: int = -1):
        text = URDF.read_text(encoding="utf-8")
        assert old in text
        path = tmp_path / "changed.urdf"
        path.write_text(text.replace(old, new, count), encoding="utf-8")
        return path

    return write


def test_the_limits_are_those_of_the_data_sheet(robot):
    np.testing.assert_allclose(np.degrees(robot.upper), [170, 120, 170, 120, 170, 120, 175])
    np.testing.assert_array_equal(robot.lower, -robot.upper)
    np.testing.assert_allclose(np.degrees(robot.velocity), [98, 98, 100, 130, 140, 180, 180])


def test_the_links_have_the_names_of_the_paper(robot):
    links = tuple(f"iiwa_link_{number}" for number in range(8))
    assert tuple(link.name for link in robot.links) == (
        *links,
        "iiwa_link_tool",
        "iiwa_tool_tip_ee",
    )
    assert robot.tip.name == "iiwa_tool_tip_ee"


def test_the_stretched_arm_is_as_long_as_the_data_sheet_says(robot):
    tip = make_kinematics(robot, "numpy").tip(np.zeros(7))
    np.testing.assert_allclose(tip[:3, 3], [0, 0, 1.266 + 0.2], atol=1e-12)


def test_the_home_pose_points_the_tool_straight_down(robot):
    np.testing.assert_allclose(np.degrees(robot.home), [0, 30, 0, -90, 0, 60, 0], atol=1e-9)
    tip = make_kinematics(robot, "numpy").tip(robot.home)
    np.testing.assert_allclose(tip[:3, 2], [0, 0, -1], atol=1e-12)
    assert tip[0, 3] > 0.3


def test_another_tip_can_be_chosen_by_name(robot):
    shorter = load_robot(tip_link="iiwa_link_tool")
    assert shorter.geometry.tool == pytest.approx(robot.geometry.tool - 0.2)
    with pytest.raises(InputError, match="behind the last joint are iiwa_link_7"):
        load_robot(tip_link="iiwa_link_3")


def test_other_meshes_replace_those_of_the_urdf(tmp_path, robot):
    (tmp_path / "visual").mkdir()
    (tmp_path / "visual" / "link_3.stl").touch()
    other = load_robot(mesh_folder=tmp_path)
    shown = [part for part in other.meshes if (part.link, part.kind) == ("iiwa_link_3", "visual")]
    assert [part.path for part in shown] == [tmp_path / "visual" / "link_3.stl"]
    kept = [part.path for part in other.meshes if part.link != "iiwa_link_3"]
    assert kept == [part.path for part in robot.meshes if part.link != "iiwa_link_3"]
    with pytest.raises(InputError, match="no mesh for this robot"):
        load_robot(mesh_folder=tmp_path / "empty")


@pytest.mark.parametrize(
    ("data", "sentence"),
    [
        (b"", "is empty"),
        (b"\x00" * 5_000_000, "larger than 4 MiB"),
        (b"\x00" * 500, "not a text file"),
        (b"\xff\xfe<\x00r\x00", "not UTF-8"),
        (b"solid cube", "not well-formed"),
        (b"<robot name='a'>", "not well-formed"),
        (b"<html/>", "should start with <robot>"),
        (b"<robot/>", "lacks a name"),
        (b"<robot name='a'/>", "has no link"),
        (b"<robot name='a'><link name='b'/></robot>", "seven revolute joints in a row, not 0"),
        (b"<robot name='a'>" + b"<link/>" * 30_000 + b"</robot>", "more than 20000 elements"),
        (
            b"<!DOCTYPE robot [<!ENTITY a 'aaaaaaaaaa'><!ENTITY b '&a;&a;&a;'>]>"
            b"<robot name='&b;'/>",
            "declares a document type",
        ),
    ],
)
def test_a_file_that_is_not_a_urdf_is_refused_in_one_sentence(tmp_path, data, sentence):
    path = tmp_path / "robot.urdf"
    path.write_bytes(data)
    with pytest.raises(InputError, match=sentence):
        load_robot(path)


def test_a_missing_file_is_refused(tmp_path):
    with pytest.raises(InputError, match="There is no file"):
        load_robot(tmp_path / "none.urdf")


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ('xyz="0 0 0.1475"', 'xyz="0 0 nan"', "iiwa_joint_1 .* not finite"),
        ('xyz="0 0 0.1475"', 'xyz="0 0 1e9"', "iiwa_joint_1 .* beyond 100 m"),
        ('xyz="0 0 0.1475"', 'xyz="0 0 up"', "lacks .* a number"),
        ('<axis xyz="0 -1 0" />', '<axis xyz="0 0 0" />', "iiwa_joint_4 .* not a direction"),
        ('<axis xyz="0 -1 0" />', '<axis xyz="0 -1" />', "iiwa_joint_4 .* not a direction"),
        ('velocity="', 'speed="', "needs a velocity limit"),
        ('lower="-', 'lower="9', "lower limit below its upper"),
        ('type="revolute"', 'type="prismatic"', "only revolute joints"),
        ('<child link="iiwa_link_2" />', "", "lacks .* a child"),
        ('<child link="iiwa_link_2" />', '<child link="iiwa_link_9" />', "missing"),
        ('<child link="iiwa_link_2" />', '<child link="iiwa_link_1" />', "not form one tree"),
        ('<parent link="iiwa_link_0" />', '<parent link="iiwa_link_7" />', "not form one tree"),
        ('<link name="iiwa_link_3">', '<link name="iiwa_link_2">', "two links of one name"),
        ('<axis xyz="0 -1 0" />', '<axis xyz="0 -1 0" /><mimic joint="iiwa_joint_1" />', "mimics"),
    ],
)
def test_an_unusable_number_or_tree_is_named(changed, old, new, sentence):
    with pytest.raises(InputError, match=sentence):
        load_robot(changed(old, new))


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        # An offset elbow, a bent wrist, an offset tool: what other 7R arms have.
        ('xyz="0 0.0105 0.1925"', 'xyz="0.045 0.0105 0.1925"', "3, 4 and 5 .* the elbow"),
        ('xyz="0 -0.0707 0.1925"', 'xyz="0.088 -0.0707 0.1925"', "5, 6 and 7 .* the wrist"),
        ('0.0105 0.1925" rpy="0 0 0"', '0.0105 0.1925" rpy="0.3 0 0"', "1 and 2 .* perpendic"),
        ('xyz="0 0 0.2"', 'xyz="0.02 0 0.2"', "on the axis of joint 7; it is 20.0 mm off"),
    ],
)
def test_an_arm_that_is_not_s_r_s_is_refused(changed, old, new, sentence):
    with pytest.raises(InputError, match=sentence):
        load_robot(changed(old, new))
