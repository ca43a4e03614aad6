"""Fits of measurements, and what they find: by what fits, or by the program."""
