"""What every controller needs: the form of a block, its layout, checked parameters, binding."""
