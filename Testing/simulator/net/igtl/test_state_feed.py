"""The newest state crosses to the event loop's thread; old ones never pile up."""

import asyncio
import threading

from rastrainer_simulator.net.state_feed import StateFeed
from rastrainer_simulator.state import StepResult
from Testing.simulator.net.igtl.servers import at_rest


def test_event_loop_gets_only_the_newest_of_the_states_that_came_while_it_was_busy(loop_thread):
    delivered = []
    feed = StateFeed(lambda _state: True, delivered.append, loop_thread.loop)

    async def be_busy():
        for tick in range(1000):
            feed(StepResult(at_rest(tick=tick)))

    loop_thread.run(be_busy())
    loop_thread.run(asyncio.sleep(0))
    assert [state.tick for state in delivered] == [999]


def test_states_are_delivered_in_the_thread_of_the_event_loop(loop_thread):
    threads = []
    done = threading.Event()

    def deliver(_state):
        threads.append(threading.current_thread())
        done.set()

    StateFeed(lambda _state: True, deliver, loop_thread.loop)(StepResult(at_rest()))
    assert done.wait(10)
    assert threads != [threading.current_thread()]


def test_state_that_is_not_due_is_not_delivered(loop_thread):
    delivered = []
    feed = StateFeed(lambda state: state.tick == 3, delivered.append, loop_thread.loop)
    for tick in range(6):
        feed(StepResult(at_rest(tick=tick)))
        loop_thread.run(asyncio.sleep(0))
    assert [state.tick for state in delivered] == [3]
