"""RAW files of cameras, developed to linear light."""
