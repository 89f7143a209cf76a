"""The compiled C on this machine: compilers, builds, loading, replay, sizes."""
