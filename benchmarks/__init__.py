"""Tables of accuracy and speed that anyone can run."""
