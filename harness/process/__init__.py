"""Runs in worker processes under a supervisor: nothing lost, nobody hurt."""
