"""Geometry buffers of subjects: rays are cast once, and the results are kept on disk."""
