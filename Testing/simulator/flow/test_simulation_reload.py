"""Other settings: used once, as soon as neither a trial nor a loading prevents it."""

from concurrent.futures import Future
from types import SimpleNamespace

import pytest

from rastrainer_simulator.flow.session.services import SET_UP_AFTER_S, SimulationReload
from rastrainer_simulator.loop.control_loop import BEING_SET_UP, TRIAL_IS_OPEN
from rastrainer_simulator.state import Answer

PRESENT, NEW = "present", "new"


class Process:
    """The process around a `SimulationReload`, which answers when a test lets it."""

    def __init__(self):
        self.loop = SimpleNamespace(is_being_replaced=False)
        self.asked, self.complaints, self.has_open_trial = [], [], False
        services = SimpleNamespace(use_settings=self._use, use_scenario=self._use)
        self.reload = SimulationReload(services, self.loop, self.complaints.append)

    @property
    def names(self):
        return [name for name, _answer in self.asked]

    def _use(self, name):
        self.asked.append((name, Future()))
        return self.asked[-1][1]

    def answer(self, message=""):
        self.asked[-1][1].set_result(Answer(0, not message, message))
        self.advance()

    def advance(self):
        self.reload.advance(SET_UP_AFTER_S, self.has_open_trial)


@pytest.fixture
def process():
    return Process()


@pytest.mark.parametrize("reason", [TRIAL_IS_OPEN, BEING_SET_UP], ids=["trial", "loading"])
def test_settings_are_not_lost_if_a_client_was_faster(process, reason):
    process.reload.request(PRESENT, NEW)
    process.advance()
    process.has_open_trial = True
    process.answer(reason)
    assert (process.complaints, process.reload.is_under_way) == ([], True)
    process.has_open_trial = False
    process.advance()
    assert process.names == [NEW, NEW]
    process.answer()
    assert not process.reload.is_under_way
