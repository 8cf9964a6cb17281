"""Scripts that Blender runs for the benchmarks."""
