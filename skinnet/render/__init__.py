"""Pictures of meshes by ray casting."""
