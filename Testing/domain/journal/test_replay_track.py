"""A journal that was tampered with is refused for replay, also where its hashes are right."""

import pytest

from rastrainer.errors import InputError
from rastrainer.journal.journal_file import FORMAT, FORMAT_VERSION, NO_LINE, encode_line
from rastrainer.journal.recording import read_track

HEADER = {
    "kind": "header",
    "format": FORMAT,
    "version": FORMAT_VERSION,
    "simTimeS": 0.0,
    "tickS": 0,
}


@pytest.fixture
def written(tmp_path):
    """Make a journal of two samples with these joint angles, rad."""

    def write(*postures):
        samples = [
            {
                "kind": "sample",
                "simTimeS": 1.0 + row,
                "tipMm": [0, 0, row],
                "clearanceMm": 9,
                "q": q,
            }
            for row, q in enumerate(postures)
        ]
        lines, previous = [], NO_LINE
        for n, entry in enumerate([HEADER, *samples], start=1):
            line, previous = encode_line(n, previous, entry)
            lines.append(line)
        path = tmp_path / "a.journal"
        path.write_bytes(b"".join(lines))
        return path

    return write


def test_a_track_has_the_joint_angles_of_each_sample(written):
    track = read_track(written([0.0] * 7, [0.5] * 7))
    assert track.q.tolist() == [[0.0] * 7, [0.5] * 7]
    assert track.at(track.trajectory.times_s.mean(), track.q).tolist() == [0.25] * 7


@pytest.mark.parametrize(
    ("posture", "sentence"),
    [
        ([0.0] * 6, "no movement to replay"),
        (["left"] * 7, "is malformed"),
        ([10**400] * 7, "is malformed"),
        (None, "is malformed"),
    ],
    ids=["six joints", "words", "huge", "none"],
)
def test_joint_angles_that_are_none_get_a_sentence(written, posture, sentence):
    with pytest.raises(InputError, match=sentence):
        read_track(written([0.0] * 7, posture))
