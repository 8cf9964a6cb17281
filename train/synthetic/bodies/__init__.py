"""Meshes of people: bald heads, their expressions and hair, bust, arms and hands.

`labelled_mesh` is what all of them are made of, and `shell` lays cloth and hair over a head.
"""
