"""Plants as FMUs: equations to C or to Python, with a solver."""
