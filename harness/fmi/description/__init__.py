"""modelDescription.xml: read, judged, and as data."""
