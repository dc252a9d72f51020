"""A journal that was tampered with is refused for replay, also where its hashes are right."""

import pytest

from rastrainer.errors import InputError
from rastrainer.journal.recording import read_track
from Testing.journal_lines import at, header, journal_bytes, sample


@pytest.fixture
def written(tmp_path):
    """Make a journal of two samples with these joint angles, rad."""

    def write(*postures):
        path = tmp_path / "trial.journal"
        samples = (at(1.0 + row, sample((0, 0, row), q=q)) for row, q in enumerate(postures))
        path.write_bytes(journal_bytes([at(0.0, header()), *samples]))
        return path

    return write


def test_a_track_has_the_joint_angles_of_each_sample(written):
    track = read_track(written([0.0] * 7, [0.5] * 7))
    assert track.q.tolist() == [[0.0] * 7, [0.5] * 7]
    assert track.at(track.trajectory.times_s.mean(), track.q).tolist() == [0.25] * 7


@pytest.mark.parametrize(
    ("posture", "sentence"),
    [
        ([0.0] * 6, "is malformed"),
        (["left"] * 7, "is malformed"),
        ([10**400] * 7, "is malformed"),
        (None, "is malformed"),
    ],
    ids=["six joints", "words", "huge", "none"],
)
def test_joint_angles_that_are_none_get_a_sentence(written, posture, sentence):
    with pytest.raises(InputError, match=sentence):
        read_track(written([0.0] * 7, posture))
