"""The look of all pictures: one colour for a solver everywhere, lines labelled where they end."""
import io

import matplotlib

matplotlib.use("agg")  # before pyplot: no display

import matplotlib.pyplot as plt  # noqa: E402
import matplotlib.ticker  # noqa: E402
from PIL import Image  # noqa: E402

# Okabe and Ito, "Color universal design", 2008.
BLACK, ORANGE, SKY, GREEN = "#000000", "#E69F00", "#56B4E9", "#009E73"
BLUE, VERMILION, PURPLE = "#0072B2", "#D55E00", "#CC79A7"  # yellow is too pale for lines
GREY = "#808080"
SERIES = [BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, BLACK, GREY]  # for what is no solver

# A dashed line shares its colour with the solver's nearest relative.
SOLVERS = {
    "auto": (BLACK, "-"),
    "multistart": (BLACK, "--"),
    "hybrid": (GREEN, "-"),
    "varpro": (BLUE, "-"),
    "newton": (ORANGE, "-"),
    "lm": (PURPLE, "-"),
    "lm_bounds": (PURPLE, "--"),
    "lm_plain": (PURPLE, "-."),
    "awls": (VERMILION, "-"),
    "awls_literal": (VERMILION, "--"),
    "awls_gss": (VERMILION, ":"),
    "awls_block": (SKY, "-"),
    "awls_accelerated": (GREY, "-"),
}
# Styles of your own solvers, in the order of their names.
OTHER_SOLVERS = [(GREEN, "--"), (BLUE, "--"), (ORANGE, "--"), (SKY, "--")]

plt.rcParams.update({
    "figure.figsize": (8, 4.8), "figure.constrained_layout.use": True,
    "font.family": "DejaVu Sans", "font.size": 10, "axes.titlesize": 11,
    "axes.titlelocation": "left", "axes.spines.top": False, "axes.spines.right": False,
    "axes.grid": True, "grid.color": "#E4E4E4", "axes.axisbelow": True, "lines.linewidth": 1.8,
    "legend.frameon": False})


def solver_style(solver, solvers=()):
    """Colour and dashes of a solver; one of your own keeps its own while the list is the same."""
    if solver not in SOLVERS:
        own = sorted(name for name in {*solvers, solver} if name not in SOLVERS)
        colour, dashes = OTHER_SOLVERS[own.index(solver) % len(OTHER_SOLVERS)]
    else:
        colour, dashes = SOLVERS[solver]
    return {"color": colour, "linestyle": dashes,
            "linewidth": 2.6 if solver == "auto" else 1.8}


def label_ends(axes, x=1.01, spacing=0.05):
    """Writes the label of each line to the right of the axes, at the height where it ends.

    Labels that would overlap are moved apart, by `spacing` of the height of the axes.
    """
    lines = [line for line in axes.get_lines() if not line.get_label().startswith("_")
             and len(line.get_xdata())]
    axes.get_xlim(), axes.get_ylim()  # matplotlib scales the axes to the data when it is asked
    to_axes = axes.transScale + axes.transLimits  # from data to fractions of the axes
    wanted = []
    for line in lines:
        height = to_axes.transform((line.get_xdata()[-1], line.get_ydata()[-1]))[1]
        wanted.append((min(max(height, 0.0), 1.0), line))
    wanted.sort(key=lambda pair: pair[0])
    heights = [height for height, _ in wanted]
    for i in range(1, len(heights)):
        heights[i] = max(heights[i], heights[i - 1] + spacing)
    if heights and heights[-1] > 1.0:
        heights[-1] = 1.0
        for i in range(len(heights) - 2, -1, -1):
            heights[i] = min(heights[i], heights[i + 1] - spacing)
    for height, (_, line) in zip(heights, wanted):
        axes.annotate(line.get_label(), xy=(x, height), xycoords="axes fraction",
                      color=line.get_color(), va="center", fontsize=9, annotation_clip=False)


def plain_numbers(axis):
    """Ticks of a logarithmic axis as 0.1, 1, 10, and 0.2, 0.5, ... where it spans two decades or
    less. To be called when the data are drawn."""
    low, high = sorted(axis.get_view_interval())
    if axis.get_scale() == "log" and high <= 100 * low:
        axis.set_major_locator(matplotlib.ticker.LogLocator(subs=(1, 2, 5)))
    axis.set_major_formatter(matplotlib.ticker.FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(matplotlib.ticker.NullFormatter())


def legend_above(figure, axes, columns=None):
    """One legend for a figure of many panels that all show the lines of these axes, in one line or
    so many columns."""
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncol=columns or len(labels), fontsize=9,
                  bbox_to_anchor=(0.5, 1.0))


def save(figure, path):
    """Writes the picture as a PNG of 256 colours, which a repository and a page can carry however
    many points it has; the same bytes for the same data. Closes the figure."""
    picture = io.BytesIO()
    figure.savefig(picture, dpi=110, bbox_inches="tight", pad_inches=0.15)  # with outer legends
    plt.close(figure)
    Image.open(picture).convert("RGB").quantize(256, dither=Image.Dither.NONE).save(
        path, optimize=True)
