"""Barragán et al., identification of Takagi–Sugeno models: its benchmark plant."""
