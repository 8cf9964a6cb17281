"""Processes that do the photographs of a run side by side, with the results of one process."""
