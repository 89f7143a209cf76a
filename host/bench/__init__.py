"""The benchmark: error against run time against bytes, of every kind and size of model."""
