"""The trial's record says what the trainee looked at, and which aids were shown."""

from __future__ import annotations

from rastrainer_simulator.record.beside_the_trial import DisplayReport, DisplayUse


def test_the_record_names_the_last_view_all_frames_and_the_aids():
    use = DisplayUse()
    assert use.summary() == {}
    use.guidance = "arrow"
    assert use.summary() == {"guidance": "arrow"}
    use.ghost = "expert"
    use.add(DisplayReport("page", "Chrome/120", 60.0, 55, 5))
    use.add(DisplayReport("headset", "Quest 3", 90.0, 88, 2))
    assert use.summary() == {
        "kind": "headset",
        "device": "Quest 3",
        "guidance": "arrow",
        "ghost": "expert",
        "refreshHz": 90.0,
        "shownFrames": 143,
        "droppedFrames": 7,
    }
