"""The evidence: kinds of model against each other on recordings, and the paper repeated."""
