"""Fitting each kind of model, and predicting with it."""
