"""Kalman filters of any model and any measurement, plain, robust or with an adapted gain."""
