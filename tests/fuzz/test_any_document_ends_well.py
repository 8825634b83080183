"""Documents close to valid ones are accepted or refused in a sentence, and quickly so."""

import time

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.fuzz.mutations import changed
from tests.fuzz.targets import TARGETS, attempt, corpus

_SECONDS = 5.0
BY_HAND = {
    "description": 150, "archive": 100, "experiment": 100, "csv": 200, "setting": 200,
    "system_structure": 100, "parameter_set": 100, "parameter_mapping": 100, "package": 100,
}  # fmt: skip


@pytest.mark.parametrize("target", TARGETS)
def test_the_corpus_has_what_is_accepted_and_what_is_not(target: str) -> None:
    accepted = [attempt(target, content) for content in corpus(target)]
    assert any(accepted) and not all(accepted)


@pytest.mark.parametrize("target", TARGETS)
def test_changed_documents(target: str) -> None:
    @settings(max_examples=BY_HAND[target], suppress_health_check=list(HealthCheck))
    @given(changed(corpus(target)))
    def check(content: bytes) -> None:
        began = time.perf_counter()
        attempt(target, content)
        assert time.perf_counter() - began < _SECONDS

    check()


@pytest.mark.parametrize("target", TARGETS)
def test_arbitrary_bytes(target: str) -> None:
    @settings(max_examples=50)
    @given(st.binary(max_size=200))
    def check(content: bytes) -> None:
        attempt(target, content)

    check()
