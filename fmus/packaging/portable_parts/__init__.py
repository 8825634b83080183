"""What every portable FMU carries along, of plants and of blocks."""
