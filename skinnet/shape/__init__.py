"""Shapes of faces."""
