"""Commands that fit and compare models."""
