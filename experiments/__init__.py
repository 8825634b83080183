"""The papers as data: one folder each, TOML experiments run by `fmu-harness run`."""
