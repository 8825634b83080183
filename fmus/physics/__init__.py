"""Components of electro-hydraulic plants as pure functions over CasADi scalars.

Every function takes and returns SI units, is smooth (C² or better) in its arguments, and states
the width of its smoothing. Pressures are absolute. No component knows a plant or an FMU.
"""
