"""Kinds of the paper that hold radial basis functions, registered in pyproject.toml."""

from springpot.modelling import Kind

_HERE = "springpot.host.wings.radial"
RBF_FD = Kind("rbf-fd", "the paper's: radial basis functions on two fractional derivatives",
              f"{_HERE}.rbf:fit_rbf_fd", "s", "#c1121f", 1)  # fmt: skip
RBF_PV = Kind("rbf-pv", "the paper's baseline: radial basis functions on position and velocity",
              f"{_HERE}.rbf:fit_rbf_pv", "^", "#e09f3e", 2)  # fmt: skip
