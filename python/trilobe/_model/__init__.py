"""Models: their tables, the BRDF that these make, and their files. Nothing but `_core` is needed for them."""
