"""`python -m Testing.code_size` prints the size of each room; `walks` counts functions called."""

import sys

from Testing.code_size.rooms import print_rooms
from Testing.code_size.walks import print_walks

if sys.argv[1:] == ["walks"]:
    print_walks()
else:
    print_rooms()
