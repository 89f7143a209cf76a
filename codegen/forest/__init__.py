"""Tree ensembles: leaves in 16 bits, two node tables, walks, quantised features, pruning."""
