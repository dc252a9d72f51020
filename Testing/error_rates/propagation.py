"""How the errors of touches end up at the targets of a procedure that steady hands carry out."""

from __future__ import annotations

import numpy as np

from rastrainer import transforms
from rastrainer.number_text import fixed
from rastrainer.procedure.errors import analyze_procedure
from rastrainer.procedure.plan import ProcedureMeshes, read_procedure_meshes
from rastrainer.registration.localization_error import stated_error
from rastrainer.registration.registration import Registration, register
from rastrainer.registration.target_error import expected_tre, target_error
from rastrainer.scenario.scenario import load_scenario
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.core.setup import DEFAULT_SCENARIO
from rastrainer_simulator.statistics.intervals import rms
from Testing.domain.procedure.procedure_records import recorded
from Testing.error_rates.measured import Measured, holds, share_of

HEADER = (
    "touches",
    "interval contains the target point error",
    "target point error, RMS, mm",
    "expected TRE there, RMS, mm",
    "ratio",
    "FRE shown, RMS, mm",
    "error at checkpoints shown, RMS, mm",
)
SCENARIO, TASK = load_scenario(asset_path(*DEFAULT_SCENARIO)), "task-3"
DBS = SCENARIO.procedure("dbs")
FLE_MM, BIAS_MM = (0.3, 1.0, 2.0), 2.0
LOWEST, HIGHEST, MAX_OFF = 0.93, 0.97, 0.05
"""Tolerances of the coverage of the 95 % interval, and of the ratio's distance from 1."""
SPREAD = 0.4
"""Approximate tolerance of the ratio of a single procedure."""


def targets(sets: int, seed: int = 21) -> list[Measured]:
    """Return the target point errors of DBS on Colin27, registered by the touches of a task."""
    rows = [_measured(f"FLE {fle:g} mm", fle, 0.0, sets, (seed, i)) for i, fle in enumerate(FLE_MM)]
    words = f"FLE 1 mm, and all touches {BIAS_MM:g} mm beside their points, to the same side"
    # The same poses and errors as in the row of FLE 1 mm.
    return [*rows, _measured(words, 1.0, BIAS_MM, sets, (seed, FLE_MM.index(1.0)))]


def registered(
    fle_mm: float, bias_mm: float, seed: tuple[int, ...]
) -> tuple[np.ndarray, Registration, np.ndarray]:
    """Return the true pose, a registration, and the errors at checkpoints that it shows, mm.

    Errors of touches are independent and alike in all directions, of RMS length `fle_mm`; all
    touches, also of checkpoints, share a bias along y. Equal seeds give equal poses and errors.
    """
    random = np.random.default_rng(seed)
    truth = SCENARIO.perturbed_head_to_world(int(random.integers(2**31)))
    points = [checkpoint.position_ras for checkpoint in DBS.checkpoints]
    fiducials = SCENARIO.task(TASK).fiducials
    places = np.concatenate([fiducials, points])
    touches = transforms.apply(truth, places) + np.array([0.0, bias_mm, 0.0])
    touches += random.normal(0.0, fle_mm / np.sqrt(3), touches.shape)
    registration = register(touches[: len(fiducials)], fiducials)
    shown = transforms.apply(registration.matrix, touches) - places
    return truth, registration, np.linalg.norm(shown[len(fiducials) :], axis=1)


def _measured(
    words: str, fle_mm: float, bias_mm: float, sets: int, seed: tuple[int, int]
) -> Measured:
    """Return the figures of many procedures, carried out exactly as they were shown."""
    inside, true, expected, fre, checks = [], [], [], [], []
    aims = np.array([trajectory.target_ras for trajectory in DBS.trajectories])
    # Obstacles play no part.
    meshes = ProcedureMeshes(read_procedure_meshes(DBS, SCENARIO.skull_path).skull, {})
    for number in range(sets):
        truth, registration, shown = registered(fle_mm, bias_mm, (*seed, number))
        done = recorded(DBS, transforms.inverse(registration.matrix))
        analysis = analyze_procedure(done, DBS, meshes, truth)
        known = stated_error(np.full(len(registration.labels), fle_mm))
        expected += expected_tre(registration, aims, known, 0.0).tolist()
        for errors, aim in zip(analysis.trajectories, aims, strict=True):
            true.append(errors.target_point_error.mm)
            interval = target_error(registration, aim, common_bias_sd_mm=0.0).interval_mm
            inside.append(holds(interval, true[-1]))
        fre.append(registration.fre_mm)
        checks += shown.tolist()
    ratio = rms(true) / rms(expected)
    further = (
        *(fixed(rms(values), 3) for values in (true, expected)),
        fixed(ratio, 2),
        *(fixed(rms(values), 3) for values in (fre, checks)),
    )
    if bias_mm:
        return Measured(words, share_of(inside), sets, further=further)

    def is_near(standard_errors: float) -> bool:
        return abs(ratio - 1) <= MAX_OFF + SPREAD * standard_errors / np.sqrt(sets)

    # The errors at the two targets of one procedure are correlated: one set counts as one.
    return Measured(words, share_of(inside), sets, HIGHEST, LOWEST, further, also=is_near)
