"""The parts of `trilobe.mitsuba`, by Dr.Jit."""
