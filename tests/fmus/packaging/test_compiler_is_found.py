"""Which C compiler is taken, and what is said when there is none or it is broken."""

import importlib.util
import sys
from pathlib import Path

import pytest

from fmus.packaging.compiler import (
    Compiler,
    Platform,
    compile_library,
    find_compiler,
    running_platform,
)
from fmus.packaging.errors import PackagingError


def test_cc_of_the_environment_comes_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    script = tmp_path / "mycc"
    script.write_text(f"#!{sys.executable}\nprint('my compiler 1.0')\n")
    script.chmod(0o755)
    monkeypatch.setenv("CC", f"{script} -m64")
    compiler = find_compiler()
    assert compiler is not None
    assert compiler.command == (str(script), "-m64")
    assert compiler.identity.endswith("my compiler 1.0")


def test_a_cc_that_does_not_run_is_passed_over(monkeypatch: pytest.MonkeyPatch) -> None:
    expected = find_compiler()
    monkeypatch.setenv("CC", "no-such-compiler")
    assert find_compiler() == expected


def test_none_without_any(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    monkeypatch.delenv("CC", raising=False)
    found = find_compiler()
    if importlib.util.find_spec("ziglang") is None:
        assert found is None
    else:
        assert found is not None and "ziglang" in found.command


def test_a_broken_compiler_is_quoted(tmp_path: Path) -> None:
    (tmp_path / "all.c").write_text("#error broken on purpose\n")
    compiler = find_compiler()
    assert compiler is not None
    with pytest.raises(PackagingError, match="broken on purpose"):
        compile_library(compiler, tmp_path, "all.c", tmp_path / "out.so", 3)
    with pytest.raises(PackagingError, match="did not run"):
        absent = Compiler(("no-such-compiler",), "")
        compile_library(absent, tmp_path, "all.c", tmp_path / "out.so", 3)


@pytest.mark.parametrize(
    ("platform", "fmi_2"),
    [
        ("x86_64-linux", "linux64"),
        ("x86_64-windows", "win64"),
        ("x86_64-darwin", "darwin64"),
        ("aarch64-linux", "aarch64-linux"),
        ("aarch64-darwin", "aarch64-darwin"),
    ],
)
def test_folders_of_both_versions(platform: str, fmi_2: str) -> None:
    assert Platform(platform, ".so").folder(2) == fmi_2
    assert Platform(platform, ".so").folder(3) == platform


def test_an_unnamed_platform_points_to_the_portable_fmu(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("platform.machine", lambda: "riscv64")
    with pytest.raises(PackagingError, match="portable"):
        running_platform()
