"""Ahn & Truong, Online tuning fuzzy PID controller using robust extended Kalman filter, 2009."""
