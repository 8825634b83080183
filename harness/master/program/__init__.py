"""A plan as memory, addresses and operations, and the loop that executes them."""
