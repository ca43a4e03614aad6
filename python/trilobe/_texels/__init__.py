"""Surfaces of a few materials, with strengths a texel: fitted, read and written."""
