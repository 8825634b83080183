"""What a signal source is, how it is seeded, and how seconds become integer nanoseconds.

A source is data (a frozen dataclass). Its sampler is asked for values at sample instants, given
as integer nanoseconds in consecutive chunks. The values never depend on how the instants are cut
into chunks, and random values depend only on the seed and on how many instants came before.

This module refuses to know who reads a signal, and what the signals are.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.random import PCG64, Generator, SeedSequence
from numpy.typing import NDArray

Times = NDArray[np.int64]
Values = NDArray[np.float64]


class Sampler(Protocol):
    """A source in use: holds what it must remember between chunks."""

    def sample(self, times_ns: Times) -> Values:
        """Values at `times_ns` (ns, shape (n,), not decreasing, after those of earlier calls)."""
        ...


@runtime_checkable
class SignalSource(Protocol):
    """A signal as data; `unit` None means the unit of the port that it is wired to."""

    @property
    def unit(self) -> str | None:
        """Its unit, if it states one."""
        ...

    def sampler(self, seed: SeedSequence) -> Sampler:
        """A fresh sampler; the same seed gives the same values, bit for bit."""
        ...


@dataclass(frozen=True)
class FunctionSampler:
    """A sampler that is a function of the instants, which may draw from a random generator."""

    function: Callable[[Times], Values]

    def sample(self, times_ns: Times) -> Values:
        """The function's values at `times_ns`."""
        return self.function(times_ns)


def named_seed(seed: int, *names: str) -> SeedSequence:
    """The seed of the random source with these names, e.g. `named_seed(7, "force", "noise")`.

    It depends on the names and on nothing else, so that adding a component to a system, or
    exchanging the controller, leaves the noise of all others as it was: compared variants meet
    identical disturbances.
    """
    digest = hashlib.sha256("\0".join(names).encode()).digest()
    words = np.frombuffer(digest, dtype="<u4")
    return SeedSequence(seed, spawn_key=tuple(int(word) for word in words))


def child_seed(seed: SeedSequence, index: int) -> SeedSequence:
    """Child number `index` of `seed`; unlike `SeedSequence.spawn` it leaves `seed` unchanged."""
    return SeedSequence(seed.entropy, spawn_key=(*seed.spawn_key, index), pool_size=seed.pool_size)


def generator(seed: SeedSequence) -> Generator:
    """The random generator of all noise here: PCG64, named so that it is no default that moves."""
    return Generator(PCG64(seed))
