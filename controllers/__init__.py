"""Controllers and estimators: frozen parameters, explicit state, one step function each.

Nothing here knows an FMU, the harness or numba: a step function is plain Python over arrays,
written in the subset that numba compiles, so that it runs under a debugger as it stands.
"""
