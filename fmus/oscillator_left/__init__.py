"""The left half of a two-mass oscillator: a mass on a spring, pulled by a coupling force."""
