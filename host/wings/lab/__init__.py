"""The lab: measure a device, find the surface, press with a force sensor beside it."""
