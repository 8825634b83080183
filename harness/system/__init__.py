"""The system as data: components, connections, units, experiment files; checked before anything loads."""
