"""What a portable FMU carries along: pure Python, bundled under a name of its own in each FMU.

The modules import nothing but the standard library, pythonfmu and each other (relatively), because
two FMUs in one process share every module of the same absolute name.
"""
