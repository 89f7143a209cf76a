"""Model and scene resolved into what will be emitted: limits, units, state, instruction bound."""
