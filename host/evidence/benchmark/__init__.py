"""Error against run time against bytes: points, front, picks, page."""
