"""The cases of `python -m benchmarks`, by name."""

from __future__ import annotations

from benchmarks.cases import controllers, growth, identify, jobs, master, papers
from benchmarks.frame import Case

CASES: dict[str, Case] = {
    "master": master.comparisons,
    "controllers": controllers.comparisons,
    "identification": identify.comparisons,
    "jobs": jobs.comparisons,
    "growth": growth.comparisons,
    "papers": papers.comparisons,
}
