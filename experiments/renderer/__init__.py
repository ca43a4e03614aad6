"""What experiments that make pictures share: scenes, paths of light, Mitsuba, pictures."""
