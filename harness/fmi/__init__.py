"""Reading FMUs: archive, model description, binding by address, life cycle."""
