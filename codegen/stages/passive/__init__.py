"""The passive model in C: curves, Maxwell branches, flow, damage and a surface that recovers."""
