"""Regressors and tree ensembles of scikit-learn: springpot's models as theirs, theirs as models."""
