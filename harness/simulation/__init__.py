"""Simulating a single FMU of any version and kind, as `fmu-harness simulate` does."""
