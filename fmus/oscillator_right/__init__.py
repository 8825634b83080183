"""The right half of a two-mass oscillator, with the spring that couples it to the left one."""
