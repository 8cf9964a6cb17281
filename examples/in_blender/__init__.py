"""Scripts that Blender runs for the examples."""
