"""From the checked system to a run: integer time, flat plan, compiled loop."""
