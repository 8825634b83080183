"""The logger of FMI 2 is variadic: a C FMU's format and arguments arrive as one text."""

import shutil
import subprocess
import zipfile
from pathlib import Path

import pytest

from harness.errors import FmuError
from harness.fmi.binding.library import platform_tuple
from harness.fmi.binding.logger import LogMessage
from harness.fmi.fmu import Fmu

COMPILER = shutil.which("cc")
pytestmark = pytest.mark.skipif(COMPILER is None, reason="needs a C compiler")

SOURCE = r"""
#include <stdlib.h>
typedef void (*logger_t)(void *, const char *, int, const char *, const char *, ...);
typedef struct { logger_t logger; void *(*allocate)(size_t, size_t); void (*release)(void *);
                 void *finished; void *environment; } callbacks;
typedef struct { const callbacks *f; int count; } model;
void *fmi2Instantiate(const char *name, int type, const char *guid, const char *where,
                      const callbacks *f, int visible, int logging) {
    model *m = f->allocate(1, sizeof(model));
    m->f = f;
    f->logger(f->environment, name, 0, "made", "%s of type %d in %s", name, type,
              where[0] ? "a folder" : "nowhere");
    return m;
}
int fmi2SetupExperiment(void *m, int d, double t, double a, int e, double b) { return 0; }
int fmi2EnterInitializationMode(void *m) { return 0; }
int fmi2ExitInitializationMode(void *m) { return 0; }
int fmi2DoStep(void *p, double t, double h, int keep) {
    model *m = p;
    m->f->logger(m->f->environment, "x", 3, "solver",
                 "%d%% of %s at t = %.3f: %lld %g %c %x %5.1f|%-4d|%g %g %g %g %g %g %g %g %g",
                 42, "steps", t, 1234567890123LL, 1e-9, 'z', 255, 3.14159, 7,
                 1., 2., 3., 4., 5., 6., 7., 8., 9.);
    return 3;
}
int fmi2Terminate(void *m) { return 0; }
void fmi2FreeInstance(void *p) {
    model *m = p;
    m->f->logger(m->f->environment, "x", 0, "gone", 0);
    m->f->release(m);
}
"""
DESCRIPTION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="talker" guid="{1}">
  <CoSimulation modelIdentifier="talker" canHandleVariableCommunicationStepSize="true"/>
  <ModelVariables>
    <ScalarVariable name="constant" valueReference="1" causality="parameter" variability="fixed">
      <Real start="1"/>
    </ScalarVariable>
  </ModelVariables>
  <ModelStructure/>
</fmiModelDescription>
"""


@pytest.fixture(scope="module")
def talker(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("talker")
    (folder / "talker.c").write_text(SOURCE)
    library = folder / "talker.so"
    command = [str(COMPILER), "-shared", "-fPIC", "-w", "-o", str(library)]
    subprocess.run([*command, str(folder / "talker.c")], check=True)
    made = folder / "talker.fmu"
    with zipfile.ZipFile(made, "w") as archive:
        archive.writestr("modelDescription.xml", DESCRIPTION)
        archive.write(library, f"binaries/{platform_tuple()}/talker.so")
    return made


def test_format_and_arguments_become_one_text(talker: Path) -> None:
    heard: list[LogMessage] = []
    with Fmu(talker) as fmu, fmu.instantiate("speaker", logging=True, echo=heard.append) as speaker:
        speaker.enter_initialization_mode(0.0, None, None)
        speaker.exit_initialization_mode()
        with pytest.raises(FmuError) as caught:
            speaker.do_step(0.125, 0.01)
    text = "42% of steps at t = 0.125: 1234567890123 1e-09 z ff   3.1|7   |1 2 3 4 5 6 7 8 9"
    assert heard == [
        LogMessage(0, "made", "speaker of type 1 in a folder"),
        LogMessage(3, "solver", text),
        LogMessage(0, "gone", ""),
    ]
    assert str(caught.value) == (
        f"component speaker: fmi2DoStep at t = 0.125 s returned Error: {text}"
    )


def test_an_echo_that_fails_is_not_heard_again(talker: Path) -> None:
    def broken(message: LogMessage) -> None:
        raise RuntimeError("no")

    with Fmu(talker) as fmu, fmu.instantiate("speaker", logging=True, echo=broken) as instance:
        assert [m.category for m in instance.log.messages] == ["made"]
