"""Shared code of experiments that make pictures: scenes, paths of light, Mitsuba, pictures."""
