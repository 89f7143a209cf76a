"""Tree ensembles: leaves in 16 bits, two node tables, traversal, quantised features, pruning."""
