"""A paper of two experiments in a folder, with claims and a README."""

from pathlib import Path

from harness.experiment.reproduce import Paper, load_paper
from tests.harness.experiment.loops import FILE, MACHINE

CLAIMS = """
paper = "A paper of two loops"

[[claims]]
id = "harder_is_better"
page = "1"
claim = "The hard PID has the smaller error"
paper = "smaller"
experiment = "lag"
variant = "hard"
against = "soft"
metric = "iae"
below = 0.0
reason = "its gain"

[[claims]]
id = "all_stable"
page = "2"
claim = "All points end at rest | with light weights"
paper = 1.0
experiment = "machine"
variant = "light"
metric = "region_share"
above = 2.0

[[claims]]
id = "measured"
page = "3"
claim = "It was measured"
untestable = "there is no test rig"
"""
README = """# A paper

<!-- verdicts: begin -->
<!-- verdicts: end -->

Between them.

<!-- studies: begin -->
forgotten
<!-- studies: end -->
<!-- regions: begin -->
<!-- regions: end -->
The end.
"""


def paper(folder: Path, claims: str = CLAIMS) -> Paper:
    place = folder / "loops"
    place.mkdir(parents=True, exist_ok=True)
    files = {"lag.toml": FILE, "machine.toml": MACHINE, "claims.toml": claims, "README.md": README}
    for name, text in files.items():
        (place / name).write_text(text, encoding="utf-8")
    return load_paper("loops", {f"loops/{n}": place / f"{n}.toml" for n in ("lag", "machine")})
