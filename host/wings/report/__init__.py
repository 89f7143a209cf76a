"""Show results: pages on a scene and its stability, pictures, notebooks, the demo."""
