"""Synthetic renderer: heads are cast once, and lit and photographed anew on every step.

`faces` holds the data for training, and `skins` is a command. Meshes (`bodies`, `garments`,
`subjects`) are cast into buffers (`casts`). Parameters are sampled (`sampling`) and painted
(`painting`), and a camera photographs both (`photography`). `scene` holds the parameters, `labels`
what a pixel may show, and `variety` the two kinds of faces.
"""
