"""The parts of `trilobe.need`, which counts what a scene needs of its materials."""
