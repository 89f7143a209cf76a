"""The springpot: a fractional law of few numbers, and what recordings tell of them."""
