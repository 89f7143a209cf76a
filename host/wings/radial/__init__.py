"""The paper's kinds of radial basis functions; what they predict is the core's."""

from springpot.modelling import Kind

_FITS = "springpot.host.wings.radial.rbf"
RBF_FD = Kind("rbf-fd", "the paper's: radial basis functions on two fractional derivatives",
              f"{_FITS}:fit_rbf_fd", "s", "#c1121f", 1)  # fmt: skip
RBF_PV = Kind("rbf-pv", "the paper's baseline: radial basis functions on position and velocity",
              f"{_FITS}:fit_rbf_pv", "^", "#e09f3e", 2)  # fmt: skip
