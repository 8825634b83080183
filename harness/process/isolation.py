"""What the operating system lets a worker give up for ever, without being root.

A worker that isolates itself, and all that it starts, can from then on

- gain no privileges by running a setuid program (no new privileges);
- write, make or remove files only below its own temporary folder (Landlock);
- open no socket but local ones, and trace, enter or program no other part of the system (seccomp);
- send signals to nobody outside (Landlock, Linux 6.12);
- map no more memory than the run's limit, and write no file larger than `LARGEST_FILE`.

It still reads whatever its user can read, computes as long as limits allow, and shares a channel
with the supervisor, which believes what comes through it. This is a fence against accidents and
careless code, not a wall against an attacker. Only Linux is served.
"""

from __future__ import annotations

import ctypes
import os
import platform
import resource
import struct
import sys
from collections.abc import Sequence
from pathlib import Path

LARGEST_FILE = 4 * 2**30
_OPEN_FILES = 1024

_NO_NEW_PRIVILEGES, _SET_SECCOMP, _FILTER = 38, 22, 2  # of prctl
_CREATE_RULESET, _ADD_RULE, _RESTRICT_SELF = 444, 445, 446  # the same on all machines
_WRITE_FILE, _TRUNCATE, _REFER = 1 << 1, 1 << 14, 1 << 13
_MAKE_AND_REMOVE = 0b1_1111_1111 << 4
_ALLOW, _DENY = 0x7FFF0000, 0x00050000 | 13  # EACCES
_AF_UNIX = 1

_ARCHITECTURES = {"x86_64": 0xC000003E, "aarch64": 0xC00000B7}
_SOCKET = {"x86_64": 41, "aarch64": 198}
_FORBIDDEN = {  # ptrace, mount, umount2, unshare, setns, bpf, keyctl, add_key, request_key,
    # perf_event_open, userfaultfd, process_vm_writev, open_by_handle_at, kexec_load,
    # io_uring_setup, pidfd_getfd
    "x86_64": (101, 165, 166, 272, 308, 321, 250, 248, 249, 298, 323, 311, 304, 246, 425, 438),
    "aarch64": (117, 40, 39, 97, 268, 280, 219, 217, 218, 241, 282, 271, 265, 104, 425, 438),
}


def missing() -> tuple[str, ...]:
    """What cannot be had here, as phrases; empty where `isolate` does all that it promises."""
    if sys.platform != "linux":
        return ("isolation is for Linux only",)
    found = []
    version = _landlock_version()
    if version < 1:
        found.append("this kernel has no Landlock, so files can be written as by the user")
    elif version < 6:
        found.append("Landlock of this kernel is older than 6.12, so signals can be sent outside")
    if platform.machine() not in _ARCHITECTURES:
        found.append(f"no filter of system calls is known for {platform.machine()}")
    return tuple(found)


def isolate(writable: Sequence[Path], memory: int | None = None) -> None:
    """Give up, for this process and for ever, what the module says; `writable` are the folders in
    which files may be changed, `memory` the bytes that may be mapped beyond those mapped now.

    Raises `OSError` where the system offers something and then refuses it.
    """
    _limit(memory)
    _call("prctl", _NO_NEW_PRIVILEGES, 1, 0, 0, 0)
    version = _landlock_version()
    if version >= 1:
        _restrict_files(writable, version)
    if platform.machine() in _ARCHITECTURES:
        _filter_calls(platform.machine())


def _limit(memory: int | None) -> None:
    wanted = {
        resource.RLIMIT_CORE: 0,
        resource.RLIMIT_FSIZE: LARGEST_FILE,
        resource.RLIMIT_NOFILE: _OPEN_FILES,
    }
    if memory is not None:
        pages = int(Path("/proc/self/statm").read_text().split()[0])
        wanted[resource.RLIMIT_AS] = pages * resource.getpagesize() + memory
    for what, limit in wanted.items():
        hard = resource.getrlimit(what)[1]
        lower = limit if hard == resource.RLIM_INFINITY else min(limit, hard)
        resource.setrlimit(what, (lower, lower))


def _restrict_files(writable: Sequence[Path], version: int) -> None:
    handled = _WRITE_FILE | _MAKE_AND_REMOVE
    handled |= (_REFER if version >= 2 else 0) | (_TRUNCATE if version >= 3 else 0)
    network = 0b11 if version >= 4 else 0
    scoped = 0b11 if version >= 6 else 0
    fields = [handled, network, scoped][: 1 + (version >= 4) + (version >= 6)]
    attributes = ctypes.create_string_buffer(struct.pack(f"<{len(fields)}Q", *fields))
    rules = _call("syscall", _CREATE_RULESET, attributes, len(fields) * 8, 0)
    try:
        for folder in writable:
            _allow(rules, folder, handled)
        _allow(rules, Path(os.devnull), handled & (_WRITE_FILE | _TRUNCATE))
        _call("syscall", _RESTRICT_SELF, rules, 0)
    finally:
        os.close(rules)


def _allow(rules: int, path: Path, access: int) -> None:
    place = os.open(path, os.O_PATH | os.O_CLOEXEC)
    try:
        beneath = ctypes.create_string_buffer(struct.pack("<Qi", access, place))
        _call("syscall", _ADD_RULE, rules, 1, beneath, 0)
    finally:
        os.close(place)


def _filter_calls(machine: str) -> None:
    load, equal, at_least, give = 0x20, 0x15, 0x35, 0x06
    forbidden = _FORBIDDEN[machine]
    deny = 8 + len(forbidden)  # number of the last instruction
    code = [(load, 0, 0, 4), (equal, 0, deny - 2, _ARCHITECTURES[machine]), (load, 0, 0, 0)]
    code.append((at_least, deny - 4, 0, 0x40000000))
    code += [(equal, deny - 5 - i, 0, number) for i, number in enumerate(forbidden)]
    code += [
        (equal, 0, 2, _SOCKET[machine]),
        (load, 0, 0, 16),
        (equal, 0, 1, _AF_UNIX),
        (give, 0, 0, _ALLOW),
        (give, 0, 0, _DENY),
    ]
    program = b"".join(struct.pack("HBBI", *instruction) for instruction in code)
    instructions = ctypes.create_string_buffer(program)
    described = struct.pack("HxxxxxxQ", len(code), ctypes.addressof(instructions))
    handed = ctypes.create_string_buffer(described)
    _call("prctl", _SET_SECCOMP, _FILTER, ctypes.addressof(handed), 0, 0)


def _landlock_version() -> int:
    try:
        return _call("syscall", _CREATE_RULESET, None, 0, 1)
    except OSError:
        return 0


def _call(function: str, *arguments: ctypes.Array[ctypes.c_char] | int | None) -> int:
    """Call a function of the C library that returns an int; raises `OSError`."""
    given = [ctypes.c_long(one) if isinstance(one, int) else one for one in arguments]
    done = int(getattr(ctypes.CDLL(None, use_errno=True), function)(*given))
    if done < 0:
        raise OSError(ctypes.get_errno(), os.strerror(ctypes.get_errno()))
    return done
