"""The cache: same content same file, other content other file, whole files only, quick."""

import os
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import pytest

from fmus.packaging.compiler import running_platform
from fmus.packaging.errors import PackagingError, PortableFallback
from fmus.packaging.plant import native
from fmus.packaging.plant.build import cached_fmu, fmu_file
from fmus.plant import Plant
from tests.fmus.packaging.plants import oscillator, static_gain

WITHOUT_COMPILER = """
import sys, warnings
from fmpy import simulate_fmu
from tests.fmus.packaging.plants import oscillator
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    path = oscillator.fmu(3)
(notice,) = [w for w in caught if w.category.__name__ == "PortableFallback"]
assert "fmu-harness[zig]" in str(notice.message) and "oscillator" in str(notice.message)
result = simulate_fmu(str(path), stop_time=0.1)
assert abs(result["position"][-1] - 0.1) > 1e-4
"""


def test_the_second_call_takes_milliseconds_and_no_generation(
    monkeypatch: pytest.MonkeyPatch, version: int
) -> None:
    first = cached_fmu(oscillator, version)
    monkeypatch.setattr(native, "native_content", None)
    start = time.perf_counter()
    assert cached_fmu(oscillator, version) == first
    assert time.perf_counter() - start < 0.1


def test_equations_that_close_over_a_value_are_generated_anew(version: int) -> None:
    """Such a value is invisible in sources and data: each must give its own FMU."""

    def scaled(factor: float) -> Plant:
        return replace(
            static_gain,
            equations=lambda x, u, p: (
                {},
                {"product": factor * p.gain * u.a * u.b, "sum": u.a + u.b},
            ),
        )

    assert cached_fmu(scaled(1.0), version) != cached_fmu(scaled(2.0), version)
    assert cached_fmu(scaled(1.0), version) == cached_fmu(scaled(1.0), version)


def test_another_default_another_file(version: int) -> None:
    gain = replace(static_gain.parameters[0], value=9.0)
    other = replace(static_gain, parameters=(gain,))
    assert cached_fmu(other, version) != cached_fmu(static_gain, version)


def test_a_deleted_file_is_built_again(version: int) -> None:
    path = cached_fmu(static_gain, version)
    data = path.read_bytes()
    path.unlink()
    assert cached_fmu(static_gain, version) == path
    assert path.read_bytes() == data


def test_builders_at_once_leave_one_whole_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FMU_HARNESS_CACHE", str(tmp_path))
    with ThreadPoolExecutor(3) as pool:
        paths = list(pool.map(lambda _: cached_fmu(static_gain, 3), range(3)))
    assert len(set(paths)) == 1
    assert [p.name for p in paths[0].parent.iterdir()] == ["static_gain.fmu"]


def test_a_failed_build_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FMU_HARNESS_CACHE", str(tmp_path))
    monkeypatch.setattr("fmus.packaging.compiler.FLAGS", ("-no-such-flag",))
    with pytest.raises(PackagingError, match="no-such-flag"):
        cached_fmu(static_gain, 3, targets=[running_platform().tuple])
    assert not list(tmp_path.rglob("*.fmu"))
    assert not list(tmp_path.rglob(".part-*"))


def test_fmu_file_writes_into_a_new_folder(tmp_path: Path, version: int) -> None:
    path = fmu_file(oscillator, version, tmp_path / "new" / "folder")
    assert path == tmp_path / "new" / "folder" / "oscillator.fmu"
    assert path.read_bytes() == cached_fmu(oscillator, version).read_bytes()


def test_without_a_compiler_the_portable_one_with_a_notice(tmp_path: Path) -> None:
    environment = {**os.environ, "PATH": "", "FMU_HARNESS_CACHE": str(tmp_path)}
    environment.pop("CC", None)
    result = subprocess.run(
        [sys.executable, "-c", WITHOUT_COMPILER],
        cwd=Path(__file__).parents[3],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 0, result.stderr
    assert issubclass(PortableFallback, UserWarning)


@pytest.mark.parametrize("wrong", [1, 4, "3"])
def test_other_fmi_versions_are_refused(wrong: object) -> None:
    with pytest.raises(PackagingError, match="choose 2 or 3"):
        cached_fmu(oscillator, wrong)  # type: ignore[arg-type]
