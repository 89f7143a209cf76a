"""The perceptual study of the paper's section VI: does it feel like the object?"""
