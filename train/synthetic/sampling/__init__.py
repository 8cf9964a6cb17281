"""Random parameters of a scene: skin, style, surroundings, light and camera.

Skins that were measured, and those of a hybrid model, also come from here.
"""
