"""The PID law, the block with fixed gains, and rules to choose them."""
