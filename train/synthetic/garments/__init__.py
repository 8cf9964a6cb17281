"""Meshes of what a head wears: hats and veils, glasses, face masks, scarves and collars.

`wardrobe` says which of them are worn, and how often.
"""
