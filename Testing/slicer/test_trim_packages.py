"""Only those parts are cut off from libraries that no loader reads."""

import ctypes
import shutil
import sys
from pathlib import Path

import multidict._multidict
import pytest

from rastrainer.slicer.program.trim_packages import drop_symbols

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="of Linux")


def test_a_library_without_symbols_is_smaller_and_loads(tmp_path):
    library = tmp_path / "library.so"
    shutil.copy(multidict._multidict.__file__, library)
    other = tmp_path / "link.so"
    other.hardlink_to(library)
    drop_symbols(library)
    assert library.stat().st_size < 0.5 * other.stat().st_size
    assert ctypes.PyDLL(str(library)).PyInit__multidict is not None
    before, content = library.stat().st_ino, library.read_bytes()
    drop_symbols(library)
    assert library.read_bytes() == content
    assert before != other.stat().st_ino
    assert other.read_bytes() == Path(multidict._multidict.__file__).read_bytes()
