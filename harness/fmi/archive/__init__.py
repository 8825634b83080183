"""FMU archives, hostile until checked, and where they are unpacked to."""
