"""Everything that a plan moves, behind one interface: FMUs of every version and kind, blocks,
plain Python, signals."""
