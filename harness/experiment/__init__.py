"""Experiment files: their form, their variants, and running them."""
