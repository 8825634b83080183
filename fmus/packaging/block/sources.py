"""The C sources of a block's FMU: the runtime that it shares with plants, its own, and tables."""

from __future__ import annotations

from pathlib import Path

from fmus.packaging.block.interface import BlockModel, block_entries
from fmus.packaging.c_source import c_numbers, c_table, c_text, runtime_files

OWN_RUNTIME = Path(__file__).parent / "c"


def block_source_files(model: BlockModel, fmi_version: int, token: str) -> dict[str, bytes]:
    """The files to compile together, by name."""
    files = runtime_files(OWN_RUNTIME, fmi_version)
    files["model.c"] = _model_source(model, fmi_version, token).encode()
    return files


def _model_source(model: BlockModel, fmi_version: int, token: str) -> str:
    values = {
        "FMI_VERSION": fmi_version,
        "MODEL_IDENTIFIER": model.name,
        "MODEL_TOKEN": f'"{token}"',
        "MODEL_TOLERANCE": "0.0",
        "SAMPLE_TIME": f"INT64_C({model.sample_time_ns})",
        "SAMPLE_PHASE": f"INT64_C({model.phase_ns})",
        "N_X": 0,
        "N_U": len(model.inputs),
        "N_Y": len(model.outputs),
        "N_P": len(model.parameters),
        "N_STATES": len(model.states),
    }
    groups = (model.inputs, model.outputs, model.parameters, model.states)
    names = [c_text(entry.name) for entry in block_entries(model)]
    starts = c_numbers(variable.start for group in groups for variable in group)
    return "".join(
        (
            f"/* {model.name}: generated from the block's interface. */\n\n",
            "#include <math.h>\n#include <stdint.h>\n\n",
            *(f"#define {name} {value}\n" for name, value in values.items()),
            "\n",
            c_table("char *const", "model_names", names),
            c_table("double", "model_start", starts),
            c_table("int", "model_p_tunable", [str(int(p.tunable)) for p in model.parameters]),
        )
    )
