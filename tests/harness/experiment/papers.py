"""A paper of two experiments in a folder, with claims and a README."""

from pathlib import Path

from harness.experiment.claims import ClaimsSpec
from harness.experiment.evidence import Evidence, Source
from harness.experiment.judging import Verdict, judge
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


def judged(evidence: Evidence | Source, /, **claim: object) -> Verdict:
    """The verdict on a claim that is the only one of its paper."""
    source = (lambda name: evidence) if isinstance(evidence, Evidence) else evidence
    own = {"id": "c", "page": "1", "claim": "c", "experiment": "two", **claim}
    return judge(ClaimsSpec.model_validate({"paper": "p", "claims": [own]}), source)[0]
