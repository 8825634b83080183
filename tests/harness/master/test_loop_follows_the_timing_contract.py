"""Rows of random systems equal those of a brute-force simulation of the timing contract, bit for
bit: several rates, phases and delays, all types of ports, both algorithms, FMI 2 and FMI 3."""

from hypothesis import given, settings

from tests.harness.master.outcomes import compare
from tests.harness.master.random_systems import Case, systems


@settings(max_examples=150, deadline=None, derandomize=True)
@given(systems())
def test_rows_equal_those_of_the_contract(case: Case) -> None:
    compare(case)
