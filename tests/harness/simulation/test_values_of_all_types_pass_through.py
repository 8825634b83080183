"""What goes in comes out: all types, arrays with structural parameters, aliases, 64-bit integers
beyond float64, from Python values, functions and CSV files."""

from pathlib import Path

import numpy as np
import pytest

from harness import simulate
from harness.errors import UsageError
from harness.results.csv_files import write_csv
from tests.harness.simulation.fmus import TYPES_3, model_fmu, needs_compiler

pytestmark = needs_compiler
LIMITS = {
    "Float32": (-1.5, 0.1), "Int8": (-128, 127), "UInt8": (0, 255), "Int16": (-32768, 32767),
    "UInt16": (0, 65535), "Int32": (-(2**31), 2**31 - 1), "UInt32": (0, 2**32 - 1),
    "Int64": (-(2**63), 2**63 - 1), "UInt64": (0, 2**64 - 1), "Boolean": (False, True),
    "String": ("", 'says "no", twice'), "Binary": (b"", b"\x00\xff,"), "Enumeration": (1, 7),
}  # fmt: skip
KINDS = ["co-simulation", "model-exchange"]


@pytest.mark.parametrize("interface", KINDS)
def test_start_values_of_every_type(interface: str) -> None:
    for bound in (0, 1):
        starts = {f"{type_}_in": LIMITS[type_][bound] for type_ in TYPES_3}
        result = simulate(
            model_fmu("3"), interface_type=interface, stop_time=0.02, output_interval=0.01,
            start_values=starts, output_variables=["*_out"],
        )  # fmt: skip
        for type_ in TYPES_3:
            expected = LIMITS[type_][bound]
            values = result[f"{type_}_out"]
            shown = expected.hex() if isinstance(expected, bytes) else expected
            shown = np.float32(shown) if type_ == "Float32" else shown
            assert [v.item() for v in values] == [getattr(shown, "item", lambda s=shown: s)()] * 3


@pytest.mark.parametrize("interface", KINDS)
def test_a_csv_file_drives_every_type_and_the_result_reads_back(
    tmp_path: Path, interface: str
) -> None:
    def cell(value: object) -> str:
        if isinstance(value, bytes):
            return value.hex()
        return '"' + value.replace('"', '""') + '"' if isinstance(value, str) else str(value)

    rows = [[cell(LIMITS[t][i]) for t in TYPES_3] for i in (0, 1)]
    lines = ["time," + ",".join(f"{t}_in" for t in TYPES_3)]
    lines += ["0," + ",".join(rows[0]), "0.5," + ",".join(rows[0]), "0.5," + ",".join(rows[1])]
    table = tmp_path / "in.csv"
    table.write_text("\n".join(lines) + "\n")
    result = simulate(
        model_fmu("3"), interface_type=interface, stop_time=1.0, output_interval=0.25,
        inputs=table, output_variables=["*_out"],
    )  # fmt: skip
    write_csv(result, tmp_path / "out.csv")
    written = (tmp_path / "out.csv").read_text().splitlines()
    assert written[0] == '"time",' + ",".join(f'"{t}_out"' for t in TYPES_3)
    first = [f for f in written if f.startswith("0.5,")]
    assert len(first) >= 2 and first[0] != first[-1]
    expected = ["0.1", *rows[1][1:9], "1", rows[1][10], '"00ff2c"', "7"]
    assert written[-1] == "1," + ",".join(expected)


def test_arrays_take_their_size_from_a_structural_parameter() -> None:
    starts = {"n": 2, "w": [5.0, 7.0]}
    result = simulate(model_fmu("3"), stop_time=0.1, step_size=0.1, start_values=starts,
                      output_variables=["doubled", "table", "w"])  # fmt: skip
    assert result.names == (
        "doubled[1]", "doubled[2]", "table[1,1]", "table[1,2]", "table[2,1]", "table[2,2]",
        "w[1]", "w[2]",
    )  # fmt: skip
    assert list(result.data[-1]) == [10.0, 14.0, 11.0, 12.0, 21.0, 22.0, 5.0, 7.0]


def test_one_element_of_an_array_and_a_whole_array_over_time(tmp_path: Path) -> None:
    result = simulate(model_fmu("3"), stop_time=0.1, step_size=0.1, start_values={"w[2]": 9.0},
                      output_variables=["doubled"])  # fmt: skip
    assert list(result.data[-1]) == [2.0, 18.0, 6.0]
    for header, cells in (("w", ["1 2 3", "3 4 5"]), ("w[1],w[2],w[3]", ["1,2,3", "3,4,5"])):
        table = tmp_path / "in.csv"
        table.write_text(f"time,{header}\n0,{cells[0]}\n1,{cells[1]}\n")
        result = simulate(model_fmu("3"), stop_time=0.5, step_size=0.25, inputs=table,
                          event_mode=False, output_variables=["doubled"])  # fmt: skip
        assert list(result["doubled[3]"]) == [6.0, 6.0, 7.0]  # u(t) acts on the step from t on


@pytest.mark.parametrize("kind", ["1-slave", "1-model"])
def test_a_negated_alias_of_fmi_1_has_the_other_sign(kind: str) -> None:
    result = simulate(model_fmu(kind), stop_time=0.2, output_interval=0.1,
                      output_variables=["h", "minus_h"])  # fmt: skip
    assert np.array_equal(result["minus_h"], -result["h"]) and result["h"][-1] > 0.5


@pytest.mark.parametrize(("kind", "interface"), [
    ("1-slave", None), ("1-model", None), ("2", "co-simulation"), ("2", "model-exchange"),
])  # fmt: skip
def test_the_types_of_fmi_1_and_2(kind: str, interface: str | None) -> None:
    inputs = {"i_in": -7, "b_in": True, "s_in": "Grüße", **({"o_in": 7} if kind == "2" else {})}
    result = simulate(model_fmu(kind), interface_type=interface, stop_time=0.2,
                      output_interval=0.1, inputs=inputs)  # fmt: skip
    assert list(result["i_out"]) == [-7] * len(result.time)
    assert result["b_out"].all() and set(result["s_out"]) == {"Grüße"}
    assert kind != "2" or list(result["o_out"]) == [7] * len(result.time)


@pytest.mark.parametrize(("name", "value"), [
    ("Int8_in", 128), ("UInt8_in", -1), ("Int32_in", 2**31), ("UInt64_in", 2**64),
    ("Int16_in", 1.5),
])  # fmt: skip
def test_what_does_not_fit_is_refused_instead_of_wrapped(name: str, value: float) -> None:
    with pytest.raises(UsageError, match=f"'{name}' must be (between .*|a whole number) .*, not"):
        simulate(model_fmu("3"), start_values={name: value})
