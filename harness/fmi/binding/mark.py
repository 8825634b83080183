"""Which call into an FMU is under way, for whoever watches over this process.

Every call outside the loop goes between `calling` and `returned`. Nobody watches unless `watch`
has been called. This module refuses to know who watches.
"""

from __future__ import annotations

from collections.abc import Callable

Watcher = Callable[[str, str], None]
"""Told the component (or file) and the call that begins; two empty strings when it is over."""


def _nobody(component: str, call: str) -> None:
    pass


_watcher: Watcher = _nobody


def watch(watcher: Watcher) -> None:
    """From now on `watcher` is told of every call."""
    global _watcher
    _watcher = watcher


def calling(component: str, call: str) -> None:
    """A call into foreign code begins."""
    _watcher(component, call)


def returned() -> None:
    """The call has come back."""
    _watcher("", "")
