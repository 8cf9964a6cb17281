"""Narrated scripts whose pictures go into the documentation."""
