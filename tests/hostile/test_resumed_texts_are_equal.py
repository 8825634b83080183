"""A run that is resumed goes on with the strings and binaries of the one before it."""

from pathlib import Path

import numpy as np
import pytest

from harness.bench import Bench
from harness.errors import SimulationError
from harness.process.checkpoint import CHECKPOINT_FILE, Snapshot
from harness.process.limits import Limits
from tests.harness.fmi.archives import rewritten
from tests.hostile.build import description, hostile_fmu

EVERY = Limits(checkpoint=None, checkpoint_simulated=0.5)
WORD = '<String name="word" valueReference="5" causality="output"/>'
TEXTS = ("", b"", "a\udc80 word", b"\x00\xff", "7")


def bench(folder: Path, *behaviours: str) -> Bench:
    """The lag with its output in words, driven by noise."""
    document = description(3)
    document = document.replace("</ModelVariables>", WORD + "</ModelVariables>")
    document = document.replace(
        "</ModelStructure>", '<Output valueReference="5"/></ModelStructure>'
    )
    source = hostile_fmu(folder, *behaviours)
    made = Bench(stop_time=5.0, step=0.01, seed=3)
    made.fmu(
        "plant",
        rewritten(source, folder / "worded.fmu", modelDescription_dot_xml=document.encode()),
    )
    made.signal("wind", "white_noise", step=0.05, std=1.0)
    made.connect("wind", "plant.u")
    return made


def test_a_run_with_a_string_is_equal(tmp_path: Path) -> None:
    whole = bench(tmp_path / "sound").run(tmp_path / "whole")
    words = whole.values["plant.word"]
    assert len(set(words)) > 400
    broken = bench(tmp_path / "broken", "DoStep segfault 300")
    with pytest.raises(SimulationError, match="SIGSEGV"):
        broken.run(tmp_path / "run", limits=EVERY)
    first = Snapshot.from_bytes((tmp_path / "run" / CHECKPOINT_FILE).read_bytes())
    assert len(first.texts) > 200 and words[10] in first.texts
    broken.run(tmp_path / "run", resume=True)
    one, other = (tmp_path / name / "results.csv" for name in ("run", "whole"))
    assert one.read_bytes() == other.read_bytes()


def test_texts_survive_the_file() -> None:
    none = np.zeros(0)
    snapshot = Snapshot(1, 2, 3, none, none.astype(np.uint8), TEXTS, {"b": np.ones(2)}, {"f": b"1"})
    again = Snapshot.from_bytes(snapshot.to_bytes())
    assert again.texts == TEXTS and again.fmus == {"f": b"1"} and again.blocks["b"].sum() == 2.0
