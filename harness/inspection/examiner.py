"""The program of the doctor's workers:

    python -m harness.inspection.examiner CONNECTION FMU SCRATCH TASKS

TASKS are pairs of a kind of interface and the name of a check, as JSON.

It tells over the descriptor CONNECTION when a check begins and what it has found, so that whoever
started it knows where it died. There is no last word: how the process ends is examined, too.
"""

from __future__ import annotations

import json
import os
import sys
from multiprocessing.connection import Connection
from pathlib import Path

from harness.inspection.examination_process import examine
from harness.process.marker import Marker
from harness.process.task import Teller

if __name__ == "__main__":
    descriptor, fmu, scratch, tasks = sys.argv[1:]
    connection = Connection(os.dup(int(descriptor)))  # the other one is open to the very end
    asked = [(kind, name) for kind, name in json.loads(tasks)]
    examine(Path(fmu), Path(scratch), asked, Teller(Marker(), connection).tell)
