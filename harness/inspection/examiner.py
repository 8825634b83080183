"""The program of the doctor's workers:

    python -m harness.inspection.examiner CONNECTION FMU SCRATCH INTERFACE_TYPE NAME…

It tells over the descriptor CONNECTION when a check begins and what it has found, so that whoever
started it knows where it died. There is no last word: how the process ends is examined, too.
"""

from __future__ import annotations

import os
import sys
from multiprocessing.connection import Connection
from pathlib import Path

from harness.inspection.examination_process import examine
from harness.process.marker import Marker
from harness.process.task import Teller

if __name__ == "__main__":
    descriptor, fmu, scratch, kind, *names = sys.argv[1:]
    connection = Connection(os.dup(int(descriptor)))  # the other one is open to the very end
    examine(Path(fmu), Path(scratch), kind, names, Teller(Marker(), connection).tell)
