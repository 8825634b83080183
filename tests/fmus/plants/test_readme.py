"""The tables in each plant's README are those of its equations."""

import pytest

from fmus import variable_table
from fmus.variable_table import PLANTS, ReadmeError, current_readme, readme_path


@pytest.mark.parametrize("name", PLANTS)
def test_generated_parts_are_current(name):
    """If this fails: python -m fmus.variable_table."""
    assert readme_path(name).read_text(encoding="utf-8") == current_readme(name)


def test_a_readme_without_a_place_is_refused(tmp_path, monkeypatch):
    bare = tmp_path / "README.md"
    bare.write_text("# A plant\n", encoding="utf-8")
    monkeypatch.setattr(variable_table, "readme_path", lambda name: bare)
    with pytest.raises(ReadmeError, match="begin: states"):
        current_readme("hybrid_actuator")
