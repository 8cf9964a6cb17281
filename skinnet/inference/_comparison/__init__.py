"""The change of pigments between two photographs of one face.

`face_warp` brings both onto one grid, `cells` averages the grid's pixels, `colour_derivatives` has
what pigments do to colour, `estimate` solves for the change of light and of pigments together, and
`change_maps` and `picture` show it.
"""
