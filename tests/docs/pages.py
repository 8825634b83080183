"""A page of the documentation as something that can be done: its files, its edits, its commands.

A comment before a block says what becomes of it: `<!-- file: PATH -->` is written there,
`<!-- edit: PATH -->` (a diff) changes the file, of which the old lines are found exactly once.
Blocks of bash are run in the folder, in their order; what stands in a block of text after one
that `<!-- output -->` announces, must be in what it prints. `pip install -e .` is not run: what
it would leave behind, the entry points, is written by `install`.
"""

import os
import re
import shutil
import subprocess
import sys
import tomllib
from dataclasses import dataclass
from pathlib import Path

from harness.process.warm import load_loop

ROOT = Path(__file__).parents[2]
ROOMS = ("controllers", "experiments", "fmus", "harness", "tests")
PIP = "pip install -e ."
_BLOCK = re.compile(r"(?:^<!-- (\w+)(?:: (\S+))? -->\n)?^```(\w+)\n(.*?)^```$", re.M | re.S)


@dataclass(frozen=True)
class Block:
    """A block of a page: what a comment says of it (`verb`, `path`), its language and text."""

    verb: str
    path: str
    language: str
    text: str


NOT_YET = "**Not yet.**"
"""What a section says that does not run so far; its test then expects to fail."""


def text(page: str, section: str = "") -> str:
    """A page, or the section whose heading begins so."""
    whole = (ROOT / "docs" / page).read_text(encoding="utf-8")
    if not section:
        return whole
    [found] = [part for part in whole.split("\n## ") if part.startswith(section)]
    return found


def blocks(page: str, section: str = "") -> list[Block]:
    """The blocks of a page, or of a section of it."""
    found = _BLOCK.findall(text(page, section))
    return [Block(*(part or "" for part in one)) for one in found]


def follow(page: str, folder: Path, section: str = "") -> None:
    """Do in `folder` what a page, or a section of it, says."""
    printed = ""
    for block in blocks(page, section):
        if block.verb == "file":
            path = folder / block.path
            assert not path.exists(), f"{page}: {block.path} is there already"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(block.text, encoding="utf-8")
        elif block.verb == "edit":
            edit(folder / block.path, block.text)
        elif block.language == "bash" and block.text.strip() == PIP:
            install(folder)
        elif block.language == "bash":
            printed = run(block.text, folder)
        elif block.language == "text":
            missing = [line for line in block.text.splitlines() if line not in printed]
            assert not missing, f"{page}: {missing} is not in\n{printed}"


def edit(path: Path, diff: str) -> None:
    """Change a file by a diff of one place."""
    lines = [(line[:1], line[1:]) for line in diff.splitlines(keepends=True)]
    old = "".join(text for sign, text in lines if sign in " -")
    new = "".join(text for sign, text in lines if sign in " +")
    content = path.read_text(encoding="utf-8")
    assert content.count(old) == 1, f"{path} has {content.count(old)} times:\n{old}"
    path.write_text(content.replace(old, new), encoding="utf-8")


def install(folder: Path) -> None:
    """The metadata of the package in `folder`, found by whoever has it on his path."""
    project = tomllib.loads((folder / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    name, version = project["name"].replace("-", "_"), project["version"]
    metadata = folder / f"{name}-{version}.dist-info"
    metadata.mkdir(exist_ok=True)
    head = f"Metadata-Version: 2.1\nName: {project['name']}\nVersion: {version}\n"
    (metadata / "METADATA").write_text(head, encoding="utf-8")
    groups = project["entry-points"].items()
    text = "".join(
        f"[{group}]\n" + "".join(f"{k} = {v}\n" for k, v in entries.items())
        for group, entries in groups
    )
    (metadata / "entry_points.txt").write_text(text, encoding="utf-8")


def run(script: str, folder: Path) -> str:
    """What commands print, run in `folder` as in a shell of a user who has installed us."""
    tools = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    path = os.pathsep.join([str(folder), str(ROOT)])
    script = script.replace("PYTHONPATH=. ", "")  # the folder is on the path already
    done = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", script], cwd=folder, capture_output=True, text=True,
        env={**os.environ, "PATH": tools, "PYTHONPATH": path, "COLUMNS": "300"}, timeout=300,
    )  # fmt: skip
    assert done.returncode == 0, f"{script}\n{done.stdout}\n{done.stderr}"
    return done.stdout


def repository(folder: Path) -> Path:
    """A copy of this repository, as far as programs need it, with the machine code of the loop."""
    load_loop()
    for room in ROOMS:
        shutil.copytree(ROOT / room, folder / room)
    shutil.copy(ROOT / "pyproject.toml", folder)
    return folder
