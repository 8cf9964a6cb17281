"""The fit of the dynamic model that the library ships."""
