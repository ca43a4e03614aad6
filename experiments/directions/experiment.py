"""Which directions to measure: see README.md beside this file."""
import statistics

from beyond.experiment import FACTOR, tabulate, units  # noqa: F401 (the lab calls the last two)
from lab import tables

OURS = "measure"


def _pattern(row):
    """The pattern and the number of directions of a row."""
    pattern, count = row["given"].split(":")
    return pattern, int(count)


def _summary(rows):
    """A line for each number of directions and pattern."""
    psnr = {(*_pattern(row), row["material"]): row["psnr_db"] for row in rows}
    lines = []
    for count in sorted({_pattern(row)[1] for row in rows}):
        of_count = [row for row in rows if _pattern(row)[1] == count]
        for pattern, of in tables.groups([{**row, "pattern": _pattern(row)[0]} for row in of_count], "pattern").items():
            ahead = [psnr[OURS, count, row["material"]] - row["psnr_db"] for row in of
                     if (OURS, count, row["material"]) in psnr]
            ratios = [row["estimated_delta_e"] / row["delta_e"] for row in of if row["estimated_delta_e"]]
            right = sum(1 / FACTOR <= ratio <= FACTOR for ratio in ratios)
            lines.append([str(count), pattern, tables.quartiles([row["psnr_db"] for row in of], ".1f"),
                          tables.quartiles([row["delta_e"] for row in of], ".1f"),
                          f"{statistics.median(ahead):+.1f}" if ahead and pattern != OURS else "",
                          f"{right} of {len(of)}", f"{max(row['largest_albedo'] for row in of):.2f}"])
    return tables.markdown(["directions", "which", "PSNR of the whole, dB", "ΔE", f"{OURS} ahead by, dB",
                            "guess within a factor of 2", "largest albedo"], lines)


def _figure(rows):
    """PSNR by number of directions, the median of each pattern."""
    from lab import plots
    figure, axes = plots.plt.subplots(figsize=(5.5, 4))
    by_pattern = tables.groups([{**row, "pattern": _pattern(row)[0], "count": _pattern(row)[1]} for row in rows],
                               "pattern")
    for (pattern, of), colour in zip(by_pattern.items(), plots.SERIES * 2):
        medians = {count: statistics.median(row["psnr_db"] for row in some)
                   for count, some in tables.groups(of, "count").items()}
        axes.semilogx(sorted(medians), [medians[count] for count in sorted(medians)], "o-", color=colour,
                      linewidth=2.5 if pattern == OURS else 1.2, label=pattern, markersize=4)
    counts = sorted({_pattern(row)[1] for row in rows})
    axes.set_xticks(counts, [str(count) for count in counts])
    axes.minorticks_off()
    axes.set(xlabel="directions measured", ylabel="PSNR of the whole sphere [dB], median")
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1.0), ncols=3)
    return figure


def draw(drawn, _):
    """The table and the picture of the page."""
    rows = [row for row in drawn["whole"] if ":" in row["given"]]  # without the fits to whole tables
    return {"summary.md": _summary(rows), "directions": _figure(rows)} if rows else {}
