"""Every test that runs a system runs it twice: row by row, and as straight code."""

from collections.abc import Iterator

import pytest

from tests.loops import straight_code

_RUN = {"run", "run_to_end", "execute", "Bench"}


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if _RUN & vars(metafunc.module).keys():
        metafunc.parametrize("loop", ["by table", "straight"], indirect=True)


@pytest.fixture(autouse=True)
def loop(request: pytest.FixtureRequest) -> Iterator[None]:
    if getattr(request, "param", "by table") == "by table":
        yield
    else:
        with straight_code():
            yield
