"""Slicer's launchers leave no trace in the environment of what is not Slicer's."""

import os

from rastrainer.processes.clean_environment import clean_environment

LAUNCHED = {
    "APPLAUNCHER_LEVEL": "1",
    "SLICER_HOME": "/opt/Slicer/bin/..",
    "PATH": os.pathsep.join(["/opt/Slicer/bin", "/usr/bin", "/opt/Slicer/lib/Python/bin"]),
    "LD_LIBRARY_PATH": "/opt/Slicer/lib/Slicer-5.13",
    "PYTHONHOME": "/opt/Slicer/lib/Python",
    "QT_PLUGIN_PATH": "/opt/Slicer/lib/QtPlugins",
    "LANG": "C.UTF-8",
}


def test_an_environment_without_slicer_stays_as_it_is():
    mine = {"PATH": "/usr/bin", "LD_LIBRARY_PATH": "/opt/driver", "PYTHONPATH": "/home/me"}
    assert clean_environment(mine) == mine


def test_what_the_launcher_has_set_goes_and_all_else_stays():
    assert clean_environment(LAUNCHED) == {"PATH": "/usr/bin", "LANG": "C.UTF-8"}


def test_what_the_user_had_set_before_the_launcher_comes_back():
    saved = {"APPLAUNCHER_0_LD_LIBRARY_PATH": "/opt/driver", "APPLAUNCHER_0_PATH": "/mine:/usr/bin"}
    later = {"APPLAUNCHER_1_LD_LIBRARY_PATH": "/opt/Slicer/lib"}
    assert clean_environment({**LAUNCHED, **saved, **later}) == {
        "PATH": "/mine:/usr/bin",
        "LD_LIBRARY_PATH": "/opt/driver",
        "LANG": "C.UTF-8",
    }


def test_slicer_without_a_launcher_as_on_macos_is_known_by_its_home():
    bundle = {"SLICER_HOME": "/Applications/Slicer", "DYLD_LIBRARY_PATH": "/x", "HOME": "/Users/me"}
    assert clean_environment({**bundle, "PATH": "/usr/bin"}) == {
        "PATH": "/usr/bin",
        "HOME": "/Users/me",
    }


def test_names_that_windows_has_in_capitals_go_too():
    inside = {"SLICER_HOME": "C:", "LIBRARYPATHS": "x", "PATH": ""}
    assert clean_environment(inside) == {"PATH": ""}
