"""How coupled FMUs step from one instant to the next, a file for each algorithm."""
