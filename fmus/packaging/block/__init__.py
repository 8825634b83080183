"""Discrete-time blocks (controllers, estimators) as FMUs."""
