"""An isolated process: what it may no longer do is refused by the kernel, the rest goes on."""

import os
import resource
import signal
import socket
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from harness.process.isolation import isolate, missing

pytestmark = pytest.mark.skipif(bool(missing()), reason="; ".join(missing()))


def in_child(folder: Path, act: Callable[[], None], memory: int | None = None) -> str:
    """The name of what `act` raises in an isolated child, "" where it raises nothing."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            isolate((folder,), memory)
            act()
        except BaseException as fault:
            os.write(writing, type(fault).__name__.encode())
        finally:
            os._exit(0)
    os.close(writing)
    with os.fdopen(reading) as told:
        said = told.read()
    assert os.waitpid(child, 0)[1] == 0
    return said


@pytest.fixture
def own(tmp_path: Path) -> Path:
    (tmp_path / "own").mkdir()
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / "file").write_text("kept")
    return tmp_path / "own"


def test_files_elsewhere_are_read_only(own: Path) -> None:
    other = own.parent / "elsewhere"
    refused: list[Callable[[], object]] = [
        lambda: (other / "new").write_text("x"),
        lambda: (other / "file").write_text("x"),
        lambda: (other / "file").unlink(),
        lambda: (other / "file").rename(own / "file"),
        lambda: (other / "folder").mkdir(),
        lambda: (other / "link").symlink_to(own),
        lambda: os.truncate(other / "file", 0),
    ]
    for act in refused:
        assert in_child(own, act) in ("PermissionError", "OSError")  # type: ignore[arg-type]
    assert [path.name for path in other.iterdir()] == ["file"]
    assert (other / "file").read_text() == "kept"


def test_its_own_folder_and_reading_are_left(own: Path) -> None:
    def act() -> None:
        (own / "folder").mkdir()
        (own / "folder" / "a").write_text((own.parent / "elsewhere" / "file").read_text())
        (own / "folder" / "a").rename(own / "b")
        Path(os.devnull).write_text("x")
        subprocess.run(["true"], check=True)
        socket.socketpair(socket.AF_UNIX)

    assert in_child(own, act) == "" and (own / "b").read_text() == "kept"


@pytest.mark.parametrize(
    ("family", "kind"),
    [(socket.AF_INET, socket.SOCK_STREAM), (socket.AF_INET6, socket.SOCK_DGRAM),
     (socket.AF_NETLINK, socket.SOCK_RAW)],
)  # fmt: skip
def test_no_network(own: Path, family: int, kind: int) -> None:
    assert in_child(own, lambda: socket.socket(family, kind).close()) == "PermissionError"


def test_no_signal_reaches_others(own: Path) -> None:
    assert in_child(own, lambda: os.kill(os.getppid(), signal.SIGUSR2)) == "PermissionError"


def test_what_it_starts_is_as_fenced(own: Path) -> None:
    target = own.parent / "elsewhere" / "new"
    assert in_child(own, lambda: subprocess.run(["touch", target], check=True)) != ""  # type: ignore[arg-type,return-value]
    assert not target.exists()


def test_no_new_privileges_and_limits(own: Path) -> None:
    def act() -> None:
        assert "NoNewPrivs:\t1" in Path("/proc/self/status").read_text()
        assert resource.getrlimit(resource.RLIMIT_CORE) == (0, 0)
        bytearray(200 * 2**20)

    assert in_child(own, act) == ""
    assert in_child(own, act, memory=100 * 2**20) == "MemoryError"
