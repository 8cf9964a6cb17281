"""The report of a run: one page of HTML with a row for each face."""
