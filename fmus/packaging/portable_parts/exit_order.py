"""The end of pythonfmu's library at the exit of a process, put into the right order.

On Linux the library gives up its hold on Python twice at exit: first as a static object, then in a
function that runs when libraries are closed, and that one counts down a number in memory already
freed. The heap is damaged, and now and then the process aborts after all its work is done. Called
before, while Python still runs, the same function leaves nothing for the other two.

Where the library itself started Python (an importer that is not Python) nothing is done: giving up
the hold would end Python from within.
"""

from __future__ import annotations

import atexit
import ctypes
import sys
from pathlib import Path

_libraries: dict[str, ctypes.PyDLL] = {}


def release_python_before_exit(resources: str) -> None:
    """For the library of the FMU whose resources folder this is, once."""
    if resources in _libraries or sys.platform != "linux" or not sys.orig_argv:
        return
    for path in Path(resources).parent.glob("binaries/*/*.so"):
        library = _libraries[resources] = ctypes.PyDLL(str(path))
        atexit.register(library.finalizePythonInterpreter)
