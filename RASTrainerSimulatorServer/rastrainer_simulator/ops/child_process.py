"""What every short-lived process is started with that works beside the control loop."""

from __future__ import annotations

import os
import subprocess

VIEW_KEY_VARIABLE = "RASTRAINER_VIEW_KEY"
"""Holds a key that views are served for, agreed on by who starts a simulator and a window."""
BELOW_NORMAL = getattr(subprocess, "BELOW_NORMAL_PRIORITY_CLASS", 0)
"""Windows' flag of a process that gives way; elsewhere such a process raises its niceness."""


def environment_without_secrets() -> dict[str, str]:
    """Return the environment without the key that only this process may know."""
    return {name: value for name, value in os.environ.items() if name != VIEW_KEY_VARIABLE}
