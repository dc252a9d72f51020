"""The tick of Register: what else happens in it is in the record, as it is in the journal."""

from dataclasses import replace

from rastrainer.journal.recording import Recording
from rastrainer.motion.trial_motion import trial_motion
from rastrainer.protocol import CommandName, check_arguments
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.operator_input import OperatorCommand, OperatorInput
from rastrainer_simulator.record.trial_entries import TrialEntries
from rastrainer_simulator.state import Event, EventKind

DT = 0.004
CONTACT = {"from": "proximity", "to": "contact", "clearanceMm": 0.0}


def test_a_contact_in_the_tick_of_register_counts_in_the_record_as_in_the_journal(anywhere):
    simulation = Simulation(anywhere, 3)

    def step(name, **arguments):
        command = OperatorCommand(name, check_arguments(name, arguments))
        given = OperatorInput(commands=(command,))
        before = simulation.state
        return before, given, simulation.step(DT, given)

    before, given, begun = step(CommandName.START_TASK, task="task-1", trainee="P01")
    entries = TrialEntries.begun(simulation, before, begun, DT)
    entries.add(simulation, given, begun)
    for _ in range(15):
        _, given, touched = step(CommandName.CAPTURE)
        entries.add(simulation, given, touched)
    _, given, done = step(CommandName.REGISTER)
    contact = Event(EventKind.PROXIMITY, done.state.sim_time, CONTACT)
    record = entries.add(
        simulation, given, replace(done, events=(*done.events, contact))
    ).measured()
    assert record.motion["contacts"] == 1
    assert record.motion == trial_motion(Recording.of(entries.taken()).trajectory())
