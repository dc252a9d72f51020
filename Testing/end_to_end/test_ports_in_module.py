"""The ports of a real simulator, tried one after the other in the module."""

import pytest

from rastrainer.slicer.link.link_status import LinkState
from Testing.end_to_end.simulator_process import ViewedSimulator
from Testing.slicer.host.fixtures import host, module_widget  # noqa: F401


@pytest.fixture(scope="module")
def simulator(tmp_path_factory):
    records = tmp_path_factory.mktemp("lab") / "records"
    with ViewedSimulator(records, "--view-port", "0") as simulator:
        yield simulator


def test_each_port_is_recognized_and_only_the_right_one_connects(
    host,  # noqa: F811
    module_widget,  # noqa: F811
    simulator,
):
    link = module_widget.logic.session.link

    def press(button, port, words):
        host.type("portSpinBox", str(port))
        host.press(button)
        host.wait_until(lambda: words in host.text("stateText"), f"the status says: {words}")

    press("probeButton", simulator.view_port, "is a web page (HTTP)")
    press("probeButton", simulator.port, "A RASTrainer simulator answers")
    assert link.status.state is LinkState.OFF
    press("connectButton", simulator.view_port, "(HTTP)")
    assert link.connector is None
    host.press("connectButton")
    press("connectButton", simulator.port, "Connected")
