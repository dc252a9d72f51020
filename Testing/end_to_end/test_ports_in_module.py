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


@pytest.fixture
def link(module_widget):  # noqa: F811
    return module_widget.logic.session.link


def test_the_page_port_is_recognized_and_harmless_and_the_right_port_connects(
    host,  # noqa: F811
    link,
    simulator,
):
    host.type("portSpinBox", str(simulator.view_port))
    host.press("connectButton")
    host.wait_until(lambda: "(HTTP)" in host.text("stateText"), "the page is recognized")
    assert link.connector is None
    host.press("connectButton")
    host.type("portSpinBox", str(simulator.port))
    host.press("connectButton")
    host.wait_until(lambda: link.status.state is LinkState.CONNECTED, "it connects")


def test_the_test_of_a_connection_names_both_ports(host, link, simulator):  # noqa: F811
    for port, words in (
        (simulator.view_port, "is a web page (HTTP)"),
        (simulator.port, "A RASTrainer simulator answers"),
    ):
        host.type("portSpinBox", str(port))
        host.press("probeButton")
        host.wait_until(lambda w=words: w in host.text("stateText"), f"the status says: {words}")
    assert link.status.state is LinkState.OFF
