"""Commands that measure kinds of model against each other, and the paper."""
