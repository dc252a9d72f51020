"""The watch measures how long the main loop stalled, and what ran then."""

import time

from Testing.slicer.host.event_loop import LOOK_AFTER_S, StallWatch

STALL_S = 4 * LOOK_AFTER_S


def test_a_stall_is_reported_with_its_length(host):
    with StallWatch() as watch:
        host.process_events()
        time.sleep(STALL_S)
        host.wait_until(lambda: watch.longest_s >= STALL_S, "the stall is noticed")
    assert max(stall.seconds for stall in watch.stalls) == watch.longest_s


def test_the_code_that_runs_during_a_stall_is_named(host):
    host.open()
    process = host.widget.logic.session.process

    def slow():
        time.sleep(STALL_S)
        process()

    host.widget.logic.session.process = slow
    with StallWatch() as watch:
        host.wait_until(
            lambda: any("onTimeout" in stall.ran for stall in watch.stalls), "it is named"
        )
