"""Raheem 2013: the extended Kalman filter of an electro-hydraulic servo."""
