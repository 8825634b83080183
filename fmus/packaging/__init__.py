"""The only place that makes FMUs: `plant/` of plants, `block/` of discrete-time blocks.

What both share lies here: archive, cache, C compiler, model description, the C runtime in `c/`.
Arrows point from `plant/` and `block/` to here, and `block/` and `plant/` do not know each other.
"""
