"""Random signals repeat with their seed and differ by name, whatever else is in the system."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.random import SeedSequence

from harness.instruments.composition import Sum, Windowed
from harness.instruments.noise import ContaminatedNoise, WhiteNoise
from harness.instruments.source import child_seed, named_seed

TIMES = np.arange(1000, dtype=np.int64) * 10_000_000
NAME = st.text(st.characters(codec="ascii", exclude_characters="\0"), min_size=1, max_size=8)


@given(st.integers(0, 2**64), st.lists(NAME, min_size=1, max_size=3))
def test_a_name_always_gives_the_same_seed(seed: int, names: list[str]) -> None:
    first, second = named_seed(seed, *names), named_seed(seed, *names)
    assert first.generate_state(8).tolist() == second.generate_state(8).tolist()


@given(st.integers(0, 100), st.sets(st.lists(NAME, max_size=3).map(tuple), min_size=2, max_size=9))
def test_names_and_seeds_give_distinct_streams(seed: int, names: set[tuple[str, ...]]) -> None:
    seeds = [named_seed(s, *one) for one in names for s in (seed, seed + 1)]
    states = {tuple(one.generate_state(4).tolist()) for one in seeds}
    assert len(states) == len(seeds)


def test_where_one_name_ends_and_the_next_begins_matters() -> None:
    assert named_seed(1, "ab", "c").spawn_key != named_seed(1, "a", "bc").spawn_key


def test_sampling_twice_from_one_seed_repeats_even_for_signals_with_children() -> None:
    source = Sum((ContaminatedNoise(1.0), WhiteNoise(1.0)))
    seed = SeedSequence(3)
    first = source.sampler(seed).sample(TIMES)
    assert source.sampler(seed).sample(TIMES).tobytes() == first.tobytes()
    assert seed.n_children_spawned == 0


def test_child_seeds_are_those_that_numpy_would_spawn() -> None:
    spawned = SeedSequence(5, spawn_key=(1, 2)).spawn(3)[2]
    ours = child_seed(SeedSequence(5, spawn_key=(1, 2)), 2)
    assert ours.generate_state(4).tolist() == spawned.generate_state(4).tolist()


def test_parts_of_a_sum_are_uncorrelated() -> None:
    many = np.arange(100_000, dtype=np.int64)
    noise = WhiteNoise(1.0)
    total = Sum((noise, noise)).sampler(SeedSequence(1)).sample(many)
    # Independent parts have variance 2 (equal ones 4); its estimate has deviation 2·√(2/n).
    assert abs(np.var(total) - 2.0) < 5 * 2 * np.sqrt(2 / len(many))


def test_whether_a_value_is_an_outlier_does_not_depend_on_the_value() -> None:
    # First values of many seeds: with one stream for both, outliers would be the small values.
    noise, ratio = ContaminatedNoise(1.0, epsilon=1 / 16, ratio=1e9), 1e9
    x = [noise.sampler(SeedSequence(seed)).sample(TIMES[:1])[0] for seed in range(4000)]
    outliers = np.array([one / ratio for one in x if abs(one) > 1e3])
    assert abs(np.var(outliers) - 1.0) < 5 * np.sqrt(2 / len(outliers))


def test_a_window_leaves_the_values_inside_it_as_they_were() -> None:
    free = WhiteNoise(1.0).sampler(SeedSequence(1)).sample(TIMES)
    gated = Windowed(WhiteNoise(1.0), 2.0, 4.0, outside=7.0).sampler(SeedSequence(1)).sample(TIMES)
    inside = (TIMES >= 2_000_000_000) & (TIMES < 4_000_000_000)
    assert np.array_equal(gated, np.where(inside, free, 7.0))
