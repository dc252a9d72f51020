"""The parts of the tests that take long: each test is in one, and each is run by its name."""

from Testing import soak

MARKED = [
    path.relative_to(soak.ROOT).as_posix()
    for path in (soak.ROOT / "Testing").rglob("test_*.py")
    if "mark.soak" in path.read_text(encoding="utf-8")
]


def test_each_part_has_tests_and_each_test_is_in_a_part():
    places = [place for part in soak.PARTS for place in part.places]
    assert all((soak.ROOT / "Testing" / place).exists() for place in places)
    assert len(set(places)) == len(places)
    parts = [set(soak.files_of(part)) & set(MARKED) for part in soak.PARTS]
    assert all(parts)
    assert sorted(file for files in parts for file in files) == sorted(MARKED)
