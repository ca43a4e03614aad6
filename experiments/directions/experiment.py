"""Which directions to measure: see README.md beside this file."""
import statistics

from beyond import experiment as beyond
from beyond.experiment import FACTOR, units  # noqa: F401 (the lab calls the last)
from lab import materials, tables

OURS = "measure"


def tabulate(setting, results):
    """A row for each fit, with its database and whether its material is measured by more than one pattern."""
    rows = beyond.tabulate(setting, results)["whole"]
    given = {}
    for row in rows:
        given.setdefault(row["material"], set()).add(row["given"])
    return {"whole": [{**row, "database": "RGL" if row["material"] in materials.RGL else "MERL",
                       "compared": int(len(given[row["material"]]) > 1)} for row in rows]}


def _pattern(row):
    """The pattern and the number of directions of a row."""
    pattern, count = row["given"].split(":")
    return pattern, int(count)


def _right(rows):
    """How many guesses are right, of how many fits that have one."""
    ratios = [row["estimated_delta_e"] / row["delta_e"] for row in rows if row["estimated_delta_e"]]
    return f"{sum(1 / FACTOR <= ratio <= FACTOR for ratio in ratios)} of {len(ratios)}" if ratios else ""


def _summary(rows):
    """A line for each number of directions and pattern."""
    ours = {(_pattern(row)[1], row["material"]): row for row in rows if _pattern(row)[0] == OURS}
    lines = []
    for count in sorted({_pattern(row)[1] for row in rows}):
        of_count = [{**row, "pattern": _pattern(row)[0]} for row in rows if _pattern(row)[1] == count]
        for pattern, of in tables.groups(of_count, "pattern").items():
            both = [(row, ours[count, row["material"]]) for row in of if (count, row["material"]) in ours]
            ahead = [row["psnr_db"] - other["psnr_db"] for row, other in both] if pattern != OURS else []
            times = [row["delta_e"] / other["delta_e"] for row, other in both] if pattern != OURS else []
            lines.append([str(count), pattern, tables.quartiles([row["psnr_db"] for row in of], ".1f"),
                          tables.quartiles([row["delta_e"] for row in of], ".1f"),
                          f"{statistics.median(ahead):+.1f} ({min(ahead):+.1f} to {max(ahead):+.1f})" if ahead else "",
                          f"{statistics.median(times):.2f} ({min(times):.2f} to {max(times):.2f})" if times else "",
                          _right(of), f"{max(row['largest_albedo'] for row in of):.2f}"])
    return tables.markdown(["directions", "which", "PSNR of the whole, dB", "ΔE", f"ahead of {OURS} by, dB",
                            f"ΔE over that of {OURS}", "guess within a factor of 2", "largest albedo"], lines)


def _guesses(rows):
    """A line for each database: guesses of fits to 50 directions."""
    lines = []
    for database, of in tables.groups([row for row in rows if row["given"] == f"{OURS}:50"], "database").items():
        ratios = [row["estimated_delta_e"] / row["delta_e"] for row in of if row["estimated_delta_e"]]
        if not ratios:
            continue
        lines.append([database, tables.quartiles([row["delta_e"] for row in of], ".1f"),
                      tables.quartiles(ratios, ".2f"), f"{min(ratios):.2f} to {max(ratios):.2f}", _right(of)])
    return tables.markdown(["database", "ΔE", "guess over truth", "least to largest", "within a factor of 2"], lines)


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
    """The tables and the picture of the page."""
    compared = [row for row in drawn["whole"] if row["compared"]]
    if not compared:
        return {}
    return {"summary.md": _summary(compared), "guesses.md": _guesses(drawn["whole"]), "directions": _figure(compared)}
