"""A file or folder of this repository that a page names is there."""

import re
import subprocess
from pathlib import Path

import pytest

from tests.docs.pages import ROOT

ROOMS = ("harness", "controllers", "fmus", "experiments", "benchmarks", "tests", "docs")
NAMED = re.compile(rf"`((?:{'|'.join(ROOMS)})/[\w./-]+)`")
PAGES = [ROOT / name for name in ("ARCHITECTURE.md", "README.md")]
PAGES += sorted(p for p in (ROOT / "docs").rglob("*.md") if p.parent.name != "how-to-add")


def known() -> set[str]:
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True)
    files = listed.stdout.split() if listed.returncode == 0 else []
    return {str(place) for name in files for place in (Path(name), *Path(name).parents)}


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_every_path_is_there(page: Path) -> None:
    found = known()
    if not found:
        pytest.skip("no git here")
    named = set(NAMED.findall(page.read_text(encoding="utf-8")))
    assert sorted(path for path in named if path.rstrip("/") not in found) == []
