"""The system as data: components, connections, units; checked before anything loads."""
