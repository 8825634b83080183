"""The test bench: reads FMUs, plans and runs the closed loop, records, measures, draws."""
