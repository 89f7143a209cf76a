"""Perceptual studies: does it feel like the object?"""
