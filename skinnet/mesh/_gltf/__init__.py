"""glTF 2.0 files: their buffers, nodes, primitives and materials, as parts of a mesh."""
