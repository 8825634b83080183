"""An FMU's library: loaded, its functions bound by address, its life cycle, its values."""
