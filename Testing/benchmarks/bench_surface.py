"""A trace of 200 points on the face of Colin27 registered to the surface, from eight starts."""

import time

import numpy as np

from rastrainer.registration.surface_match import match_surface
from Testing.benchmarks.row import row
from Testing.domain.registration.traces import coarse_start, colin27, head_pose, places, traced


def rows(quick: bool) -> list[dict]:
    """Return the row `surface.match`, in ms; the search tree already exists."""
    head, seconds = colin27(), []
    face = places(head, "face")
    for seed in range(6 if quick else 60):
        random = np.random.default_rng(seed)
        pose = head_pose(random)
        trace, start = traced(head, face, random, pose, 0.5), coarse_start(random, pose)
        began = time.perf_counter()
        match_surface(trace, head, start, seed=seed)
        seconds.append(time.perf_counter() - began)
    return [row("surface.match", [1e3 * one for one in seconds[1:]], "ms")]
