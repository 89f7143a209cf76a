"""Show results: the page on a scene, and the demo."""
