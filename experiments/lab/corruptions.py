"""Corruptions of measurements, as `trilobe --corrupt=` takes them."""

CLEAN = "clean"


def of_kinds(kinds):
    """CLEAN, and all of {kind: [strength]}: "noise:0.05"."""
    return [CLEAN] + [f"{kind}:{strength:g}" for kind, of in kinds.items() for strength in of]


def kind_of(corruption):
    """The name of the kind."""
    return corruption.partition(":")[0]


def strength_of(corruption):
    """The strength as text."""
    return corruption.partition(":")[2]


def flags(corruption):
    """The program's flags."""
    return {} if corruption == CLEAN else {"corrupt": corruption}
