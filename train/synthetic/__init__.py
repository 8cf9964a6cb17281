"""Photometric twin: heads whose geometry is cast once and whose light is drawn on every step."""
