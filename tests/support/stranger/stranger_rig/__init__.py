"""A rig that is not springpot's: what its makers add to springpot."""
