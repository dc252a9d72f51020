"""Save a picture of the module's panel: `python -m Testing.slicer.host picture.png`."""

import sys
import tempfile
from pathlib import Path

from Testing.slicer.host.host import Host

if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        host = Host(Path(folder))
        try:
            host.open()
            host.screenshot(Path(sys.argv[1]))
        finally:
            host.close()
