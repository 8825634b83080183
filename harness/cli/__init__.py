"""The command line `fmu-harness`."""
