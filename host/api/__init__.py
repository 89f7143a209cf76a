"""The calls of springpot in Python: one for each step of the job."""
