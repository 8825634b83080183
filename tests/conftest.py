"""Every run of the tests tries the same examples: hypothesis derives them from the tests alone."""

from hypothesis import settings

settings.register_profile("repeatable", derandomize=True, deadline=None, database=None)
settings.load_profile("repeatable")
