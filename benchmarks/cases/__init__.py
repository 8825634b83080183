"""The cases of `python -m benchmarks`, by name."""

from __future__ import annotations

from benchmarks.cases.controllers import controllers
from benchmarks.cases.growth import growth
from benchmarks.cases.identify import identification
from benchmarks.cases.jobs import jobs
from benchmarks.cases.master import master
from benchmarks.cases.papers import papers
from benchmarks.frame import Case

CASES: dict[str, Case] = {
    "master": master,
    "controllers": controllers,
    "identification": identification,
    "jobs": jobs,
    "growth": growth,
    "papers": papers,
}
