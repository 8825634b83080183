"""What a run leaves behind: recording, metrics, plots."""
