"""Formulas of the features and of the passive model: what the fit and the emitted C share."""
