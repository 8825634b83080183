"""What can go wrong while a plant becomes an FMU."""

from __future__ import annotations


class PackagingError(Exception):
    """A plant cannot become an FMU; the message names the plant, the place and the way out."""


class CompilerError(PackagingError):
    """A C compiler is there and did not do what it was asked for."""


class PortableFallback(UserWarning):
    """No C compiler was found, or it failed; the portable FMU took the place of the native one."""
