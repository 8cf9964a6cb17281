"""Synthetic videos of faces whose blood changes, with the truth."""
