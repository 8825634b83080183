"""Serkies & Szabat 2013: a two-mass drive whose load inertia changes."""
