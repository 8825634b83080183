"""Blocks of a line or two: gain, difference, speed from an encoder."""
