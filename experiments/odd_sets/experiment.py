"""Samples that are few in odd ways: see README.md beside this file."""
from beyond.experiment import FACTOR, tabulate, units  # noqa: F401 (the lab calls the last two)
from lab import tables


def _summary(rows):
    """A line for each pattern, and one for all."""
    lines = []
    for given, of in [*tables.groups(rows, "given").items(), ("all", rows)]:
        ratios = [row["estimated_delta_e"] / row["delta_e"] for row in of if row["estimated_delta_e"]]
        if not ratios:
            continue
        right = sum(1 / FACTOR <= ratio <= FACTOR for ratio in ratios)
        lines.append([given, tables.quartiles([100 * row["measured_share"] for row in of], ".0f"),
                      tables.quartiles([row["delta_e"] for row in of], ".1f"), tables.quartiles(ratios, ".2f"),
                      f"{min(ratios):.2f} to {max(ratios):.2f}", f"{right} of {len(ratios)}",
                      f"{max(row['largest_albedo'] for row in of):.2f}"])
    return tables.markdown(["given", "measured, %", "ΔE of the whole", "guess over truth", "least to largest",
                            "within a factor of 2", "largest albedo"], lines)


def draw(drawn, _):
    """The table of the page."""
    rows = drawn["whole"]
    return {"summary.md": _summary(rows)} if rows else {}
