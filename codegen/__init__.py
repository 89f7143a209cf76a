"""Floor 2: model and scene -> plan -> C source. Numpy only."""
