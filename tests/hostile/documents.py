"""Hostile modelDescription.xml: changes of a good one, each with what the refusal says."""

from tests.hostile.build import description

Change = tuple[int, str, str, str]
"""FMI version, what is replaced, by what, and a pattern of the fault."""

_U2 = '<ScalarVariable name="u" valueReference="0"'
_Y2 = "</ModelVariables>"
_UNKNOWN2 = '<Unknown index="2" dependencies=""/>'
_OUTPUT3 = '<Output valueReference="1" dependencies=""/>'
_U3 = '<Float64 name="u" valueReference="0" causality="input" start="0"/>'
_HEAD = '<?xml version="1.0" encoding="UTF-8"?>'


def _more(fmi: int, variables: str, words: str) -> Change:
    return fmi, "</ModelVariables>", variables + "</ModelVariables>", words


def _real(name: str, reference: int, attributes: str, causality: str = "local") -> str:
    return (
        f'<ScalarVariable name="{name}" valueReference="{reference}" causality="{causality}">'
        f"<Real {attributes}/></ScalarVariable>"
    )


def _array(attributes: str = "", dimension: str = 'start="3"') -> str:
    return (
        f'<Float64 name="a" valueReference="9" causality="parameter" variability="fixed" '
        f"{attributes}><Dimension {dimension}/></Float64>"
    )


_LAUGHS = "<!DOCTYPE l [<!ENTITY l0 'ha'>" + "".join(
    f"<!ENTITY l{i + 1} '{f'&l{i};' * 10}'>" for i in range(12)
) + "]>"  # fmt: skip

CHANGES: dict[str, Change] = {
    "wrong root": (2, "fmiModelDescription", "model", "has the root element <model>, not <fmiM"),
    "no version": (2, 'fmiVersion="2.0"', "", "states no fmiVersion"),
    "version of the future": (2, '"2.0"', '"7.5"', "is of FMI version '7.5'; versions 1.0"),
    "version that is a word": (3, '"3.0"', '"3.x"', "is of FMI version '3.x'"),
    "FMI 3 called FMI 2": (3, '"3.0"', '"2.0"', "is not valid"),
    "no guid": (2, 'guid="{hostile}"', "", "is not valid: .*guid"),
    "no model name": (3, 'modelName="hostile"', "", "is not valid: .*modelName"),
    "no identifier": (3, 'modelIdentifier="hostile"', "", "is not valid: .*modelIdentifier"),
    "identifier with a path": (
        3, 'Identifier="hostile"', 'Identifier="../../../../lib/libc"', "which is no name of a file"
    ),
    "identifier of dots": (2, 'Identifier="hostile"', 'Identifier=".."', "no name of a file"),
    "line feed in the model name": (2, '"hostile"', '"a&#10;b"', "control characters in its"),
    "control character in a name": (2, 'name="u"', 'name="a&#133;b"', "'a b' with control char"),
    "no name": (2, 'name="u"', "", "is not valid: .*name"),
    "no value reference": (3, 'name="u" valueReference="0"', 'name="u"', "valueReference"),
    "negative value reference": (2, 'Reference="0"', 'Reference="-1"', "is not valid"),
    "no variables at all": (3, "<ModelVariables>", "<Variables>", "cannot be read"),
    "name twice": (2, 'name="u"', 'name="y"', 'name "y" .* is not unique'),
    "value reference twice": (3, _U3, _U3.replace('"0"', '"1"', 1), "same value reference"),
    "two inputs in one place": _more(
        2, _real("w", 0, 'start="0"', "input"), "inputs 'u' and 'w' with the same value reference 0"
    ),
    "unknown type": (3, "<Float64 name=\"u\"", "<Float65 name=\"u\"", "is not valid"),
    "start that is no number": (2, '<Real start="0.1"/>', '<Real start="one"/>', "is not valid"),
    "start of no Float64": (3, 'start="0.1"', 'start="0,1"', "'T' .*start value '0,1'|not valid"),
    "start beyond Int8": _more(
        3, '<Int8 name="i" valueReference="9" causality="parameter" start="300"/>', "not valid"
    ),
    "min above max": (2, '<Real start="0.1"/>', '<Real start="1" min="2" max="0"/>',
                      "'T' with min 2 above max 0"),
    "no start": (2, '<Real start="0.1"/>', "<Real/>", "has no start value"),
    "input that is a constant": (
        3, 'causality="input"', 'causality="input" variability="constant"', "not allowed|illegal"
    ),
    "declared type that is not": (
        2, '<Real start="0.1"/>', '<Real declaredType="X" start="1"/>', "has not been defined"
    ),
    "unit of factor 0": (
        2, "<ModelVariables>", '<UnitDefinitions><Unit name="X"><BaseUnit m="1" factor="0"/></Unit>'
        "</UnitDefinitions><ModelVariables>", "unit 'X' with factor 0 .* nothing can be converted"
    ),
    "unit of no exponent": (
        2, "<ModelVariables>", '<UnitDefinitions><Unit name="X"><BaseUnit m="1.5"/></Unit>'
        "</UnitDefinitions><ModelVariables>", "is not valid"
    ),
    "unknown number 0": (2, _UNKNOWN2, '<Unknown index="0"/>', "refers to variable number 0"),
    "unknown number 99": (2, _UNKNOWN2, '<Unknown index="99"/>', "number 99 .*numbers 1 to 4"),
    "dependency number 9": (
        2, _UNKNOWN2, '<Unknown index="2" dependencies="1 9"/>', "refers to variable number 9"
    ),
    "derivative of number 0": _more(2, _real("d", 9, 'derivative="0"'), "derivative of variable 0"),
    "derivative of itself": _more(2, _real("d", 9, 'derivative="5"'), "in a circle: 'd'"),
    "derivatives in a circle": _more(
        2, _real("d", 9, 'derivative="6"') + _real("e", 10, 'derivative="5"'), "circle: 'd' -> 'e'"
    ),
    "output that is not": (3, _OUTPUT3, '<Output valueReference="77"/>', "value reference 77"),
    "dependency that is not": (3, 'dependencies=""', 'dependencies="77"', "value reference 77"),
    "derivative that is not": _more(
        3, '<Float64 name="d" valueReference="9" derivative="77"/>', "derivative=77, which no"
    ),
    "derivatives of FMI 3 in a circle": _more(
        3, '<Float64 name="d" valueReference="9" derivative="10"/>'
        '<Float64 name="e" valueReference="10" derivative="9"/>', "derivative go in a circle"
    ),
    "clock that is none": _more(
        3, '<Float64 name="d" valueReference="9" clocks="0"/>', "'u' is of type Float64"
    ),
    "clocks in a circle": _more(
        3, '<Clock name="c" valueReference="9" clocks="10" intervalVariability="triggered"/>'
        '<Clock name="k" valueReference="10" clocks="9" intervalVariability="triggered"/>',
        "clocks go in a circle: 'c' -> 'k'",
    ),
    "dimension that is not": _more(3, _array('start="1"', 'valueReference="77"'), "by 77, which"),
    "dimension that is no size": _more(
        3, _array('start="1"', 'valueReference="2"'), "by 'T', which is no structural parameter"
    ),
    "dimension of nothing": _more(3, _array('start="1"', ""), "a dimension of no size"),
    "too many start values": _more(3, _array('start="1 2"'), r"3 element\(s\) with 2 start"),
    "array that no memory holds": _more(
        3, _array('start="1"', 'start="1099511627776"'), "says that 'a' has 1099511627776 elements"
    ),
    "clock that never stops ticking": _more(
        3, '<Clock name="c" valueReference="9" causality="input" intervalVariability="constant" '
        'intervalCounter="0" resolution="0"/>', "'c' with interval 0/0"
    ),
    "states that no memory holds": (
        2, "<fmiModelDescription ", '<fmiModelDescription numberOfEventIndicators="4000000000" ',
        "says numberOfEventIndicators=4000000000"
    ),
    "negative dimension": _more(3, _array('start="1"', 'start="-3"'), "is not valid"),
    "external entity": (
        2, _HEAD, _HEAD + '<!DOCTYPE f [<!ENTITY e SYSTEM "file:///etc/hosts">]>', "has a DOCTYPE"
    ),
    "a billion laughs": (
        2, _HEAD + "\n<fmiModelDescription ", _HEAD + _LAUGHS
        + '<fmiModelDescription description="&l12;" ', "cannot be read|DOCTYPE"
    ),
    "deep nesting": (2, "</ModelStructure>", "</ModelStructure>" + "<a>" * 5000, "cannot be read"),
    "huge attribute": (2, 'guid="', 'guid="' + "a" * 11_000_000, "cannot be read"),
    "cut": (2, "</fmiModelDescription>", "", "cannot be read"),
    "NUL": (2, 'name="u"', 'name="\0"', "cannot be read"),
    "control character": (2, 'name="u"', 'name="\x1b[31m"', "cannot be read"),
    "two roots": (2, "</fmiModelDescription>", "</fmiModelDescription><a/>", "cannot be read"),
    "attribute twice": (2, 'guid="', 'guid="1" guid="', "cannot be read"),
    "unknown encoding": (2, 'encoding="UTF-8"', 'encoding="klingon"', "cannot be read"),
}  # fmt: skip

HARMLESS: dict[str, Change] = {
    "unknown attribute": (3, 'name="T"', 'name="T" strange="1"', "'strange' is not allowed"),
    "date that is none": (
        3, 'modelName="hostile"', 'modelName="hostile" generationDateAndTime="today"', "'today' is"
    ),
    "empty list": (2, "<ModelVariables>", "<LogCategories/><ModelVariables>", "Missing child"),
    "annotations behind others": (
        3, "</ModelVariables>",
        "</ModelVariables><Annotations><Annotation type='a'/></Annotations>",
        "'Annotations': This element is not expected"
    ),
    "continuous integer": (2, "<Real start=\"0\"/>", "<Integer start=\"0\"/>", "must have variab"),
    "parameter that is continuous": (
        2, 'causality="parameter" variability="fixed"', 'causality="parameter"', "not allowed"
    ),
    "start of what is calculated": (
        3, 'name="y" valueReference="1" causality="output" initial="exact"',
        'name="y" valueReference="1" causality="output"', "'y' with initial=\"calculated\", but"
    ),
    "no independent variable": (
        3, '<Float64 name="time" valueReference="3" causality="independent" '
        'variability="continuous"/>', "", "not one independent variable"
    ),
    "unit that is not": (
        2, '<Real start="0.1"/>', '<Real unit="X" start="1"/>', "'T' with the unit 'X', which is"
    ),
    "display unit of no unit": (
        2, '<Real start="0.1"/>', '<Real displayUnit="X" start="1"/>', "display unit 'X', which is"
    ),
    "start that is not finite": (
        3, 'initial="exact" start="0.1"', 'initial="exact" start="INF"', "'T' that starts at INF"
    ),
    "nominal of nothing": (2, '<Real start="0.1"/>', '<Real nominal="0" start="1"/>', "nominal 0"),
    "step below 0": (
        2, "<ModelVariables>", '<DefaultExperiment stepSize="-0.1"/><ModelVariables>',
        "says stepSize=-0.1, which is disregarded"
    ),
    "tolerance that is no number": (
        3, "<ModelVariables>", '<DefaultExperiment tolerance="NaN"/><ModelVariables>',
        "says tolerance=nan"
    ),
    "end that is never reached": (
        2, "<ModelVariables>", '<DefaultExperiment stopTime="INF"/><ModelVariables>',
        "says stopTime=inf"
    ),
    "end before the start": (
        2, "<ModelVariables>", '<DefaultExperiment startTime="2" stopTime="1"/><ModelVariables>',
        "says stopTime=1, which is disregarded: it must be finite and above 2"
    ),
    "internal step below 0": (
        3, "<CoSimulation ", '<CoSimulation fixedInternalStepSize="-1" ',
        "says fixedInternalStepSize=-1"
    ),
}  # fmt: skip
"""The same for what changes no value, each with what the note says."""

BYTES: dict[str, tuple[bytes, str]] = {
    "empty": (b"", "cannot be read"),
    "not UTF-8": (description(2).replace('name="u"', 'name="ü"').encode("latin-1"), "be read"),
    "binary": (bytes(range(256)) * 40, "cannot be read"),
    "JSON": (b'{"fmiVersion": "3.0"}', "cannot be read"),
    "HTML": (b"<html><body>Not found<br></body></html>", "cannot be read"),
}
