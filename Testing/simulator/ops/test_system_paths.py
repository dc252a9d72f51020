"""Settings are where each system's users look for them."""

import sys
from pathlib import Path

import pytest

from rastrainer_simulator.ops.system_paths import config_folder


@pytest.mark.parametrize(
    ("platform", "variable", "value", "folder"),
    [
        ("linux", "XDG_CONFIG_HOME", "somewhere", Path("somewhere", "rastrainer")),
        ("linux", "XDG_CONFIG_HOME", "", Path("home", ".config", "rastrainer")),
        ("win32", "APPDATA", "roaming", Path("roaming", "RASTrainer")),
        ("darwin", "HOME", "", Path("home", "Library", "Application Support", "RASTrainer")),
    ],
)
def test_the_settings_folder_of_each_system(monkeypatch, platform, variable, value, folder):
    monkeypatch.setattr(sys, "platform", platform)
    monkeypatch.setattr(Path, "home", lambda: Path("home"))
    monkeypatch.setenv(variable, value)
    assert config_folder() == folder
