"""Discrete-time blocks (controllers, estimators) as FMUs that need no Python where they run."""

from fmus.packaging.blocks.build import cached_block_fmu, package_block
from fmus.packaging.blocks.interface import BlockModel, BlockVariable

__all__ = ["BlockModel", "BlockVariable", "cached_block_fmu", "package_block"]
