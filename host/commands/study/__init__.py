"""Commands of perceptual studies."""
