"""From the checked system to a run: integer time, plan, program, compiled loop."""
