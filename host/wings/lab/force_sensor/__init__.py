"""A force sensor beside a device: its samples, its clock, and how late it is."""
