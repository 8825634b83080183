"""What an FMU says against what it does: static faults and behaviour."""
