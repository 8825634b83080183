"""What a portable FMU of a block carries along: Python that imports the standard library and numpy.

The modules refer to each other relatively and are bundled under a name of their own in each FMU,
because two FMUs in one process share every module of the same absolute name.
"""
