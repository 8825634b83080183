"""Descriptions drawn at random for `c/table.c`, which fits any of them."""

from itertools import count

from hypothesis import strategies as st

from tests.every_way.cases import STEP_NS, Case
from tests.every_way.descriptions import OLD_TYPES, Alias, Model, Variable, fmi1, fmi2, fmi3
from tests.every_way.models import TYPES, folder, pack
from tests.every_way.plain_events import SECOND

STEPS = 4
_numbers = count()


@st.composite
def cases(draw: st.DrawFn, version: int) -> Case:
    """An FMU of outputs of which some share a reference, and of inputs that change half way."""
    old = [t for t in TYPES if t in OLD_TYPES and t != "Enumeration"]
    types = st.sampled_from(TYPES if version == 3 else old)
    places = st.lists(st.tuples(st.integers(0, 11), types), min_size=1, max_size=8)
    if version == 3:
        places = places.filter(lambda some: len({reference for reference, _ in some}) == len(some))
    outputs = draw(places)
    fed = draw(st.lists(st.sampled_from(outputs), max_size=3, unique_by=lambda place: place[0]))
    signed = {"Float64", "Int32", "Boolean"} if version == 1 else set()
    variables = []
    for i, (reference, type_) in enumerate(outputs):
        signs = draw(st.lists(st.booleans(), max_size=2))
        aliases = tuple(
            Alias(f"y{i}_{j}", negated=sign and type_ in signed) for j, sign in enumerate(signs)
        )
        size = _dimensions(version, reference)
        variables.append(Variable(f"y{i}", reference, type_, aliases=aliases, dimensions=size))
    inputs = {}
    for i, (reference, type_) in enumerate(fed):
        size = _dimensions(version, reference)
        variables.append(
            Variable(f"u{i}", reference + 50, type_, "input", _start(type_), dimensions=size)
        )
        if not size:
            values = draw(st.tuples(*[_values(type_)] * 2))
            inputs[f"u{i}"] = ((0, values[0]), (STEPS // 2 * STEP_NS, values[1]))
    model = Model("table", tuple(draw(st.permutations(variables))), ("co-simulation",),
                  stop=STEPS * STEP_NS / SECOND)  # fmt: skip
    watched = [name for v in variables if v.causality == "output"
               for name in (v.name, *(alias.name for alias in v.aliases))]  # fmt: skip
    text = {1: lambda m: fmi1(m, "co-simulation"), 2: fmi2, 3: fmi3}[version](model)
    flags = ["-DSCALARS"] * (version < 3) + ["-DSLAVE"] * (version == 1)
    path = pack(folder() / f"drawn{next(_numbers)}.fmu", model, version, text, *flags)
    return Case("drawn", model, version, "co-simulation", tuple(watched), inputs,
                path=path)  # fmt: skip


def _dimensions(version: int, reference: int) -> tuple[int, ...]:
    """As `c/table.c` has them."""
    size = 1 + reference % 5
    return (size,) if version == 3 and size > 1 else ()


def _start(type_: str) -> str:
    return {"Boolean": "false", "String": "", "Binary": "00", "Enumeration": "1"}.get(type_, "0")


def _values(type_: str) -> st.SearchStrategy[object]:
    kinds: dict[str, st.SearchStrategy[object]] = {
        "Boolean": st.booleans(), "String": st.sampled_from(["", "one", "two"]),
        "Binary": st.sampled_from([b"1", b"22"]), "Enumeration": st.sampled_from([1, 7]),
    }  # fmt: skip
    return kinds.get(type_, st.integers(0, 20))
