"""Where the next points of the present trial's trace would help most, found in a thread."""

from __future__ import annotations

import logging
from concurrent.futures import Future, ThreadPoolExecutor

import numpy as np

from rastrainer import transforms
from rastrainer.errors import RASTrainerError
from rastrainer.head.mesh import read_head_mesh
from rastrainer.registration.surface_error import COVERED_MM, TraceGuide
from rastrainer.scenario.scenario import Camera
from rastrainer.transforms import MM_PER_M
from rastrainer.trial.touch_registration import trace_guide
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.loop.timing import raise_thread_priority
from rastrainer_simulator.presentation.messages import SkinPlace
from rastrainer_simulator.presentation.presenter import TraceGuidance
from rastrainer_simulator.state import SimulationState
from rastrainer_simulator.training.head_pose import Truth
from rastrainer_simulator.trial_state import TraceState
from rastrainer_simulator.vectors import Vector, in_meters, vector
from rastrainer_simulator.viewpoint.view_control import Orbit, orbit_beside

LOOK_S = 0.25
"""Time between two searches; a search takes about 10 ms."""
EYE_M = 0.45
"""Distance of the viewpoint from the next place."""

_log = logging.getLogger(__name__)


class TracePlaces:
    """Guides through the trace of one trial after another.

    The places are marks on the patient's skin, as fiducials are: they are found and drawn where
    the head truly is.
    """

    def __init__(self) -> None:
        # Set aside while it holds the interpreter, it would make the control loop wait.
        self._worker = ThreadPoolExecutor(1, "next places", raise_thread_priority)
        self._guide: tuple[SimulationSetup, TraceGuide] | None = None
        self._trial: tuple[str, SimulationSetup, Truth] | None = None
        self._asked: TraceState | None = None
        self._found: Future[SkinPlace | None] | None = None
        self._place: SkinPlace | None = None
        self._since_s = 0.0

    def begin(self, trial: tuple[str, SimulationSetup, Truth] | None) -> None:
        """Guide through another trial, by its ID; through none if it is None."""
        self._trial = trial
        self._asked = self._found = self._place = None

    def close(self) -> None:
        self.begin(None)
        self._worker.shutdown(wait=False)

    def advance(self, dt: float, state: SimulationState) -> None:
        """Collect the result, and search the next place of a trace that has changed."""
        self._since_s += dt
        if self._found is not None and self._found.done():
            self._place, self._found = self._found.result(), None
        training = state.training
        if self._trial is None or not training.is_tracing or training.trial_id != self._trial[0]:
            return
        trace = training.trace
        if trace is None or trace is self._asked:
            return
        if self._found is not None or self._since_s < LOOK_S:
            return
        self._asked, self._since_s = trace, 0.0
        self._found = self._worker.submit(self._find, *self._trial[1:], trace)

    def guidance(self, state: SimulationState) -> TraceGuidance:
        training = state.training
        is_traced = training.trace is not None and training.next_point is None
        if self._trial is None or training.trial_id != self._trial[0] or not is_traced:
            return TraceGuidance()
        return TraceGuidance(COVERED_MM, self._place)

    def in_world(self) -> Vector | None:
        if self._trial is None or self._place is None:
            return None
        place = self._trial[2].in_world(np.array(self._place.position_mm))
        return in_meters(place)

    def orbit(self, camera: Camera) -> Orbit | None:
        """Return a view of the next place; None if there is no next place."""
        place = self.in_world()
        if self._trial is None or self._place is None or place is None:
            return None
        outward = self._trial[2].head_to_world[:3, :3] @ np.array(self._place.normal)
        return orbit_beside(camera, place, vector(outward.tolist()), EYE_M)

    def _find(self, setup: SimulationSetup, truth: Truth, trace: TraceState) -> SkinPlace | None:
        """Return the next place; called in the thread."""
        try:
            if self._guide is None or self._guide[0] is not setup:
                mesh = read_head_mesh(setup.scenario.head)
                self._guide = setup, trace_guide(setup.scenario, mesh)
            guide = self._guide[1]
        except (RASTrainerError, OSError):
            _log.exception("The next place of a trace cannot be found")
            return None
        world = np.array([point.seen for point in trace.points]).reshape(-1, 3)
        places = transforms.apply(transforms.inverse(truth.head_to_world), MM_PER_M * world)
        found = guide.next_place(places, trace.is_on)
        if found is None:
            return None
        position, normal = np.round(found.position, 2), np.round(found.normal, 4)
        return SkinPlace(vector(position.tolist()), vector(normal.tolist()))
