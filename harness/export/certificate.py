"""The parity certificate of an exported FMU: what the same model did in this process.

It lies in the FMU at `extra/fmu-harness.parity/certificate.json` and holds inputs, the outputs of
the in-process object, the largest difference of the FMU to them where it was made, and versions.
Whoever has the FMU replays it on a machine of his own (`fmu-harness verify`). Numbers are written
with the digits that read back to the same bits.
"""

from __future__ import annotations

import json
import zipfile
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from harness.errors import FmuError
from harness.fmi.fmu import Fmu

MEMBER = "extra/fmu-harness.parity/certificate.json"
FORMAT = 1


@dataclass(frozen=True)
class Certificate:
    """Row k of `inputs` is held during step k of `step` (s), row k of `outputs` is read after it.

    `reference` says what computed the outputs; `difference` is the largest one of the FMU's to
    each output where it was made (empty where it was made for other machines only), `tolerance`
    the share of an output's range that may differ elsewhere, where another mathematical library
    rounds otherwise.
    """

    model: str
    reference: str
    step: float
    inputs: Mapping[str, tuple[float, ...]]
    outputs: Mapping[str, tuple[float, ...]]
    difference: Mapping[str, float]
    tolerance: float
    made_with: Mapping[str, str]
    format: int = FORMAT

    def as_bytes(self) -> bytes:
        """JSON, UTF-8."""
        return (json.dumps(asdict(self), indent=1, ensure_ascii=False) + "\n").encode()

    @classmethod
    def from_bytes(cls, text: bytes, source: Path) -> Certificate:
        """Raises `FmuError` where `source` holds something else."""
        try:
            data = json.loads(text)
            columns = {
                group: {str(n): tuple(map(float, column)) for n, column in data[group].items()}
                for group in ("inputs", "outputs")
            }
            found = cls(**{**data, **columns, "step": float(data["step"])})
            lengths = {len(c) for group in columns.values() for c in group.values()}
            if found.format != FORMAT or len(lengths) != 1 or not columns["outputs"]:
                raise ValueError("another form")
        except (ValueError, TypeError, KeyError, AttributeError) as fault:
            raise FmuError(f"the parity certificate of {source} cannot be read: {fault}") from fault
        return found

    @property
    def rows(self) -> int:
        """Number of communication steps."""
        return len(next(iter(self.outputs.values())))


def read_certificate(fmu: Fmu) -> Certificate:
    """The certificate in an opened FMU; raises `FmuError` when there is none."""
    path = fmu.folder / MEMBER
    if not path.is_file():
        raise FmuError(
            f"FMU {fmu.path} has no parity certificate; those that `fmu-harness build` writes do"
        )
    return Certificate.from_bytes(path.read_bytes(), fmu.path)


def with_certificate(path: Path, target: Path, certificate: Certificate) -> None:
    """Write the FMU at `path` with the certificate to `target`, its other bytes unchanged."""
    with zipfile.ZipFile(path) as source, zipfile.ZipFile(target, "w") as made:
        for member in source.infolist():
            if member.filename != MEMBER:
                made.writestr(member, source.read(member))
        made.writestr(zip_entry(MEMBER), certificate.as_bytes())


def zip_entry(name: str) -> zipfile.ZipInfo:
    """A member of an archive that is the same wherever and whenever it is written."""
    entry = zipfile.ZipInfo(name, date_time=(1980, 1, 1, 0, 0, 0))
    entry.compress_type, entry.create_system = zipfile.ZIP_DEFLATED, 3
    entry.external_attr = 0o644 << 16
    return entry
