"""A rig that is not springpot's: what its makers add to springpot."""

from springpot.trainer.kinds import Kind

# The function by its name: commands that fit nothing load nothing that fits.
SPRING = Kind("spring", "an elastic curve", "stranger_rig.spring:fit_spring")
