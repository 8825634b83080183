"""All kinds of signals by name, and making one from the data of an experiment."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from harness.errors import ExperimentError
from harness.instruments import composition, csv_signal, noise, waveforms
from harness.instruments.checks import Signal, build
from harness.instruments.source import SignalSource

MODULES = (waveforms, noise, csv_signal, composition)  # they register their kinds
SIGNALS = Signal.kinds


def make_signal(kind: str, parameters: Mapping[str, Any]) -> SignalSource:
    """The signal of this kind, or of a class of your own, "package.module:Class"; where a signal is
    made of others they stand in `signal` or `signals` as tables with `kind` beside their own keys.

    Raises `ExperimentError` naming an unknown kind or key with the nearest legal ones, a missing
    key, or a value out of its bounds.
    """
    given = with_signals(kind, parameters)
    made: SignalSource = build("signal", SignalSource, SIGNALS, kind, given)
    return made


def with_signals(owner: str, parameters: Mapping[str, Any]) -> dict[str, Any]:
    """`parameters` with the tables under `signal` and `signals` made into signals."""
    made = dict(parameters)
    if "signal" in made:
        made["signal"] = _nested(owner, made["signal"])
    if isinstance(made.get("signals"), list | tuple):
        made["signals"] = tuple(_nested(owner, one) for one in made["signals"])
    return made


def _nested(owner: str, given: Any) -> Any:
    if not isinstance(given, Mapping):
        return given
    if "kind" not in given:
        raise ExperimentError(
            f"{owner!r}: a signal inside it lacks 'kind', got the keys {', '.join(given)}"
        )
    return make_signal(given["kind"], {k: v for k, v in given.items() if k != "kind"})
