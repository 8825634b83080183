"""Fuzzy systems as data: memberships, inference, exact derivatives, Takagi–Sugeno models."""
