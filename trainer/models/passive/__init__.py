"""The passive model: its terms, their non-negative fit, and the choice among them."""
