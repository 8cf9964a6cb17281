"""The web page, served from the installed package."""
