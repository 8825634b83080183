"""Whoever follows a page on how to add something has it in the end: code, tests, commands."""

from pathlib import Path

import pytest

from tests.docs.pages import ROOT, blocks, follow, install, repository, run
from tests.every_way.models import needs_compiler

IN_THE_REPOSITORY = ("controller", "plant", "signal", "metric", "algorithm", "fmi-function")
PAGES = (*IN_THE_REPOSITORY, "own-package")


@needs_compiler
@pytest.mark.parametrize("page", IN_THE_REPOSITORY)
def test_in_this_repository(page: str, tmp_path: Path) -> None:
    install(repository(tmp_path))
    follow(f"how-to-add/{page}.md", tmp_path)
    paths = {block.path for block in blocks(f"how-to-add/{page}.md")}
    python = " ".join(sorted(path for path in paths if path.endswith(".py")))
    run(f"ruff check {python} && ruff format --check {python}", tmp_path)


@needs_compiler
def test_in_a_package_of_ones_own(tmp_path: Path) -> None:
    follow("how-to-add/own-package.md", tmp_path)


def test_the_index_has_every_page() -> None:
    index = (ROOT / "docs/how-to-add/README.md").read_text(encoding="utf-8")
    there = {path.stem for path in (ROOT / "docs/how-to-add").glob("*.md")} - {"README"}
    assert there == set(PAGES)
    assert all(f"({page}.md)" in index for page in there)


@pytest.mark.parametrize("page", PAGES)
def test_every_page_has_a_test_and_a_command(page: str) -> None:
    found = blocks(f"how-to-add/{page}.md")
    assert any("/test_" in block.path for block in found if block.verb == "file")
    assert any("pytest" in block.text for block in found if block.language == "bash")
