"""What a photograph, or another of its session, shows of its own light and camera."""
