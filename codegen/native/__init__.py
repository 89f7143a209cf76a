"""C compilers of this machine, and libraries of C in this process."""
