"""All that touches numba and LLVM: step functions as machine code, calls by address."""
