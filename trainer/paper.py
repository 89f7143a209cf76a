"""Settings of the paper that the command line shows without loading what fits."""

PAPER_SMOOTH_S = 0.025  # 25 samples at 1 kHz (section III-C)
