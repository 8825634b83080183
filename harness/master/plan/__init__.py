"""The schedule of one cycle: instants, rates, and who is read and written first."""
