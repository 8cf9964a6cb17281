"""Synthetic renderer: heads are cast once, and lit and photographed anew on every step."""
