"""Floor 3: recordings -> features -> fitted models. The only floor that loads scikit-learn."""

PAPER_SMOOTH_S = 0.025  # 25 samples at 1 kHz (section III-C): of the paper's training data
