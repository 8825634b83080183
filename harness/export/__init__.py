"""Taking what runs here to other tools."""
