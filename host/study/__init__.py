"""A perceptual study: does it feel like the object?"""
