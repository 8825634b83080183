"""What is written reads back as the same document; what was not understood is still there."""

import zipfile
from pathlib import Path
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree

from harness.ssp import binding, markup
from harness.ssp.common import (
    KINDS,
    Annotation,
    BaseUnit,
    DataType,
    LinearTransformation,
    MapEntry,
    MappingTransformation,
    UnitDefinition,
)
from harness.ssp.document import (
    CONNECTOR_KINDS,
    Component,
    Connection,
    Connector,
    DefaultExperiment,
    ParameterBinding,
    SystemElement,
    SystemStructure,
)
from harness.ssp.parameters import Parameter, ParameterSet, ParameterValue
from harness.ssp.rewrite import rewrite_package
from tests.harness.ssp.packages import NAMESPACES, archive

TEXT = st.text(st.characters(codec="utf-8", exclude_categories=("Cs", "Cc")), max_size=8)
NAMES = TEXT.filter(bool)
REALS = st.floats(allow_nan=False)
KEPT = st.sampled_from(
    ['<a:x xmlns:a="urn:a" b="1"> t <a:y></a:y></a:x>', "<x>&amp;<!-- why --></x>"]
)
ANNOTATIONS = st.lists(
    st.builds(Annotation, type=NAMES, text=NAMES.map(str.strip), more=st.tuples(KEPT)), max_size=2
).map(tuple)
GEOMETRY = st.sampled_from(
    [(), (f'<ssd:ElementGeometry xmlns:ssd="{markup.NAMESPACES["ssd"]}" x1="0" x2="1.50" y1="0" '
          'y2="1"></ssd:ElementGeometry>',)]
)  # fmt: skip
TRANSFORMATIONS = st.one_of(
    st.none(),
    st.builds(LinearTransformation, factor=REALS, offset=REALS),
    st.builds(
        MappingTransformation,
        tag=st.sampled_from(MappingTransformation.TAGS),
        entries=st.lists(st.builds(MapEntry, source=TEXT, target=TEXT), max_size=2).map(tuple),
    ),
)
CONNECTORS = st.lists(
    st.builds(
        Connector, name=TEXT, kind=st.sampled_from(CONNECTOR_KINDS), description=st.none() | TEXT,
        type=st.none() | st.builds(
            DataType, tag=st.sampled_from([f"ssc:{kind}" for kind in KINDS]), unit=st.none() | TEXT
        ),
        annotations=ANNOTATIONS,
    ), max_size=2,
).map(tuple)  # fmt: skip
BINDINGS = st.lists(
    st.builds(
        ParameterBinding, prefix=TEXT,
        inline=st.none() | st.builds(
            ParameterSet, version=st.just("1.0"), name=TEXT, parameters=st.tuples(
                st.builds(Parameter, name=TEXT, value=st.builds(ParameterValue, value=TEXT))
            ),
        ),
    ), max_size=1,
).map(tuple)  # fmt: skip
PARTS: dict[str, Any] = {
    "name": NAMES, "connectors": CONNECTORS, "geometry": GEOMETRY, "bindings": BINDINGS,
    "annotations": ANNOTATIONS,
}  # fmt: skip
COMPONENTS = st.builds(Component, source=st.none() | TEXT, **PARTS)
CONNECTIONS = st.builds(
    Connection, start_connector=TEXT, end_connector=TEXT, start_element=st.none() | TEXT,
    suppress_unit_conversion=st.booleans(), transformation=TRANSFORMATIONS,
    annotations=ANNOTATIONS,
)  # fmt: skip


def system(inner: st.SearchStrategy[Any]) -> st.SearchStrategy[SystemElement]:
    return st.builds(
        SystemElement,
        elements=st.lists(inner, max_size=3).map(tuple),
        connections=st.lists(CONNECTIONS, max_size=2).map(tuple),
        **PARTS,
    )


STRUCTURES = st.builds(
    SystemStructure, version=st.sampled_from(["1.0", "2.0"]), name=TEXT,
    system=system(st.one_of(COMPONENTS, system(COMPONENTS))),
    units=st.lists(
        st.builds(UnitDefinition, name=TEXT, base=st.builds(BaseUnit, kg=st.integers(-9, 9),
                                                            factor=REALS, offset=REALS)),
        max_size=2,
    ).map(tuple),
    experiment=st.none() | st.builds(DefaultExperiment, stop_time=st.none() | REALS),
    annotations=ANNOTATIONS,
)  # fmt: skip


@settings(max_examples=40)
@given(STRUCTURES)
def test_writing_then_reading_is_the_identity(structure: SystemStructure) -> None:
    content = binding.write(structure)
    assert binding.read(SystemStructure, content, "test") == structure
    assert binding.write(binding.read(SystemStructure, content, "test")) == content


FOREIGN = f"""<ssd:SystemStructureDescription {NAMESPACES} xmlns:t="urn:tool" version="1.0" name="n"
    author="A &amp; B" t:stamp="7">
  <ssd:System name="root" description="ü">
    <ssd:Connectors><ssd:Connector name="p" kind="parameter"><ssc:Real unit="m"/>
      <ssd:ConnectorGeometry x="0.500" y="1"/></ssd:Connector></ssd:Connectors>
    <ssd:Elements>
      <ssd:System name="z"/><ssd:Component name="b" source="resources/b.fmu">
        <ssd:ElementGeometry x1="0" y1="0.0" x2="1e1" y2="2" iconSource="i.png"/>
        <ssc:MetaData kind="general" type="text/x"><ssc:Content><t:m/></ssc:Content></ssc:MetaData>
      </ssd:Component><ssd:Component name="a" source="resources/a.fmu" t:colour="red"/>
    </ssd:Elements>
    <ssd:Connections><ssd:Connection startElement="b" startConnector="y" endElement="a"
      endConnector="u"><ssd:ConnectionGeometry pointsX="1 2" pointsY="3 4"/></ssd:Connection>
    </ssd:Connections>
    <ssd:SystemGeometry x1="0" y1="0" x2="9" y2="9"/>
    <ssd:GraphicalElements><ssd:Note x1="0" y1="0" x2="1" y2="1" text="two&#10;lines"/>
    </ssd:GraphicalElements>
    <ssd:Annotations><ssc:Annotation type="org.tool" xmlns:q="urn:q"><t:deep
      xmlns:xsi="urn:xsi" xsi:type="q:kind"> text <t:er/> tail </t:deep></ssc:Annotation>
    </ssd:Annotations>
  </ssd:System>
  <ssd:DefaultExperiment stopTime="1.5"/>
</ssd:SystemStructureDescription>"""


def shape(element: Any) -> Any:
    """An element without the white space between elements."""
    return (
        element.tag, sorted(element.attrib.items()), (element.text or "").strip(),
        (element.tail or "").strip(), [shape(one) for one in element],
    )  # fmt: skip


def test_a_package_of_another_tool_comes_out_as_it_went_in(tmp_path: Path) -> None:
    files = {"SystemStructure.ssd": FOREIGN, "resources/a.fmu": b"\0a", "extra/org.tool/x": b"x"}
    source = archive(tmp_path / "in.ssp", files)
    rewrite_package(source, tmp_path / "out.ssp", (), {})
    rewrite_package(tmp_path / "out.ssp", tmp_path / "again.ssp", (), {})
    assert (tmp_path / "out.ssp").read_bytes() == (tmp_path / "again.ssp").read_bytes()
    with zipfile.ZipFile(tmp_path / "out.ssp") as made:
        assert set(made.namelist()) == set(files)
        assert made.read("extra/org.tool/x") == b"x"
        found = etree.fromstring(made.read("SystemStructure.ssd"))
    assert shape(found) == shape(etree.fromstring(FOREIGN.encode()))
    (kept,) = found.iter("{urn:tool}deep")
    assert kept.nsmap["q"] == "urn:q", "the prefix in xsi:type still means something"
