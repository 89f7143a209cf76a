"""C as WebAssembly: built, measured, run in node."""
