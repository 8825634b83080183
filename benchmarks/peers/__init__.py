"""Other tools, each in an environment of its own, in the same closed loop as ours."""
