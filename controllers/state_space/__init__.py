"""Linear-quadratic design, pole placement, and the state controllers that follow from them."""
