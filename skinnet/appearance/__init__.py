"""Statistics of the appearance of faces."""
