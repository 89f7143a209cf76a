"""Wings: the core runs without them, and each uses only the names that `springpot` exports."""
