"""A synchronous generator at an infinite bus, controlled by its field voltage."""
