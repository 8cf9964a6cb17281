"""Light, camera and renderer, which turn casts and paintings into photographs and their truth."""
