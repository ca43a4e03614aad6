"""Starting points: see README.md beside this file."""
import math

from lab import fits, stats, tables
from lab.fits import Fit

ONE = ("solver", "threads", "weighting")  # the tables know one of each
CHECKPOINTS = (5, 10, 20, 40)  # sweeps, and the last one


def units(setting):
    return fits.planned(setting)


def tabulate(setting, results):
    """E after so many sweeps, or after the last one where the fit ended earlier."""
    last = setting.manifest["flags"]["max_iterations"]
    checkpoints = [sweeps for sweeps in CHECKPOINTS if sweeps < last] + [last]
    rows = []
    for result in results:
        trace = Fit(result.folder).trace if result.folder else [{"objective": math.inf}]
        rows += [{"material": result.labels["material"], "start": result.labels["start"],
                  "seed": result.labels["seed"], "sweeps": sweeps,
                  "objective": trace[min(sweeps, len(trace) - 1)]["objective"]}
                 for sweeps in checkpoints]
    return {"objectives": rows}


def _ratios(rows):
    """{(start, seed): [E over the lowest that any start has reached by then, one a material]}"""
    ratios = {}
    for of in tables.groups(rows, "material").values():
        best = min(row["objective"] for row in of)
        for row in of:
            ratios.setdefault((row["start"], row["seed"]), []).append(
                stats.ratio(row["objective"], best))
    return ratios


def draw(drawn, _):
    from lab import plots
    rows = drawn["objectives"]
    at = {sweeps: _ratios(of) for sweeps, of in tables.groups(rows, "sweeps").items()}
    starts = list(at[max(at)])
    lines = []
    for start, seed in starts:
        cells = [f"{stats.geometric_mean(of[start, seed]):.3f}, worst {max(of[start, seed]):.2f}, "
                 f"best on {sum(ratio == 1 for ratio in of[start, seed])}" for of in at.values()]
        lines.append([start, str(seed), *cells])
    figure, axes = plots.plt.subplots()
    for (start, seed), colour in zip(starts, plots.SERIES):
        axes.plot(list(at), [stats.geometric_mean(of[start, seed]) for of in at.values()],
                  marker="o", color=colour, label=f"{start}, seed {seed}")
    count = len({row["material"] for row in rows})
    axes.set(xscale="log", xlabel="sweeps of awls", ylabel="E over the lowest of any start by then",
             title=f"Geometric mean over {count} materials")
    axes.set_xticks(list(at), [str(sweeps) for sweeps in at])
    axes.minorticks_off()
    plots.label_ends(axes)
    return {"starts": figure, "starts.md": tables.markdown(
        ["start", "seed", *(f"{sweeps} sweeps" for sweeps in at)], lines)}
