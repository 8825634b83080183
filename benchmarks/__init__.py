"""Benchmarks: what the harness costs, measured against C and against other ways to do the same."""
