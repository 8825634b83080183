"""Takagi–Sugeno models of a plant from data, offline on rows or online in the loop."""
