"""The lead loop here and in Ecos, as a picture for the documentation:

python -m tests.peers.picture docs/one_sample_later.png
"""

from __future__ import annotations

import sys
import tempfile
import warnings
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from tests.peers.ssp_loops import SIGNALS, experiment, exported, ours, theirs

VARIANT, STEP, STOP = "pid", 0.01, 0.6


def main() -> None:
    """Draw it to the file named on the command line."""
    warnings.simplefilter("ignore")
    here = ours(experiment(2, STOP), VARIANT)
    delayed = ours(experiment(2, STOP, delay=STEP), VARIANT)
    with tempfile.TemporaryDirectory() as folder:
        package = exported(experiment(2, STOP), VARIANT, Path(folder))
        there = theirs("ecos", package, STEP, len(here))
    force, control = SIGNALS.index("plant.force"), SIGNALS.index("controller.u")
    computed = STEP * np.arange(len(here))  # u of row k was computed at t_k, and acts from
    figure, (above, below) = plt.subplots(2, 1, sharex=True, figsize=(8, 5.5), layout="constrained")
    for rows, later, look, label in (
        (here, 0.0, {"color": "C0"}, "here"),
        (delayed, STEP, {"color": "C1"}, "here, with a delay of 10 ms on controller.u → plant"),
    ):
        above.plot(computed + STEP, rows[:, force], label=label, **look)
        below.step(computed + later, rows[:, control], where="post", **look)
    dots = {"marker": "o", "ms": 4, "mfc": "none", "ls": "", "color": "black"}
    above.plot(computed + STEP, there[:, force], label="Ecos, the same experiment as .ssp", **dots)
    below.plot(computed + STEP, there[:, control], **dots)
    above.set(ylabel="force in N", xlim=(0.08, 0.4))
    above.legend(frameon=False, loc="lower right")
    below.set(ylabel="command that acts on the plant", xlabel="time in s")
    for axes in (above, below):
        axes.grid(alpha=0.3)
    figure.savefig(sys.argv[1], dpi=110)


if __name__ == "__main__":
    main()
