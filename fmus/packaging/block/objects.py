"""From the LLVM module of a step to object files, for this machine and for others.

The code is made for the generic processor of each architecture, so that an FMU runs wherever its
platform does. Nothing is reassociated or contracted: LLVM keeps every operation and rounding of
the module, so machines differ only as far as their libraries of mathematics do.
"""

from __future__ import annotations

import re
from functools import lru_cache

import llvmlite.binding as llvm

from fmus.packaging.errors import PackagingError

TRIPLES = {
    "x86_64-linux": "x86_64-unknown-linux-gnu",
    "aarch64-linux": "aarch64-unknown-linux-gnu",
    "x86_64-windows": "x86_64-pc-windows-gnu",
    "x86_64-darwin": "x86_64-apple-macosx11.0.0",
    "aarch64-darwin": "arm64-apple-macosx11.0.0",
}
_TARGET = re.compile(r"^target (triple|datalayout) = .*\n", re.MULTILINE)


def object_code(module: str, platform: str) -> bytes:
    """The object file of an LLVM module for `platform`, named as FMI 3 does.

    Raises PackagingError for a platform that is not known or that this LLVM cannot compile for.
    """
    if platform not in TRIPLES:
        raise PackagingError(f"No block is compiled for {platform!r}; known are {sorted(TRIPLES)}.")
    machine = _machine(TRIPLES[platform])
    head = f'target datalayout = "{machine.target_data}"\ntarget triple = "{machine.triple}"\n'
    parsed = llvm.parse_assembly(head + _TARGET.sub("", module))
    parsed.verify()
    options = llvm.create_pipeline_tuning_options(speed_level=2)
    builder = llvm.create_pass_builder(machine, options)
    builder.getModulePassManager().run(parsed, builder)
    code: bytes = machine.emit_object(parsed)
    return code


@lru_cache(maxsize=len(TRIPLES))
def _machine(triple: str) -> llvm.TargetMachine:
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    try:
        target = llvm.Target.from_triple(triple)
    except RuntimeError as error:
        raise PackagingError(f"This LLVM does not compile for {triple}: {error}") from error
    return target.create_target_machine(cpu="", features="", opt=2, reloc="pic")
