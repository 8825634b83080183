"""The only place that makes FMUs: a plant (`fmus.plant`) goes in, an `.fmu` comes out."""

from fmus.packaging.cache import cache_directory, cached_fmu, fmu_file
from fmus.packaging.errors import PackagingError, PortableFallback

__all__ = ["PackagingError", "PortableFallback", "cache_directory", "cached_fmu", "fmu_file"]
