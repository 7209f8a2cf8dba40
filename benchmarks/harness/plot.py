"""Plots in log-log. Figures whose scale is not positive are left out."""

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as pyplot  # noqa: E402

# Told apart also by people who see few colours (Okabe and Ito 2008).
COLOURS = ["#d55e00", "#0072b2", "#56b4e9", "#009e73", "#cc79a7", "#e69f00"]
MARKS = ["o", "s", "D", "^", "v", "P"]


def panels(path, figures, columns=3):
    """Writes one picture of several plots.

    A figure is {"title", "x", "y", "curves": [{"label", "points": [(x, y)], optional "style"}], optional "slope": a guide line's}.
    """
    matplotlib.rcParams.update({"font.size": 9, "svg.hashsalt": "tyndall"})
    rows = -(-len(figures) // columns)
    canvas, axes = pyplot.subplots(rows, columns, figsize=(4.2 * columns, 3.5 * rows), squeeze=False)
    for axis in axes.flat[len(figures) :]:
        axis.set_visible(False)
    for axis, figure in zip(axes.flat, figures):
        draw(axis, figure)
    canvas.tight_layout()
    canvas.savefig(path, metadata={"Date": None} if str(path).endswith(".svg") else None, dpi=120)
    pyplot.close(canvas)


def draw(axis, figure):
    """One plot."""
    corner = None
    for curve in figure["curves"]:
        points = sorted(point for point in curve["points"] if point[0] > 0 and point[1] > 0)
        if not points:
            continue
        number = curve.get("style", 0)
        x, y = zip(*points)
        axis.loglog(x, y, MARKS[number % 6] + "-", color=COLOURS[number % 6], label=curve["label"], markersize=4)
        corner = corner or points[0]
    if corner and "slope" in figure:
        low, high = axis.get_xlim()
        guide = [corner[1] * (x / corner[0]) ** figure["slope"] for x in (low, high)]
        limits = axis.get_ylim()
        axis.loglog([low, high], guide, ":", color="#999999", label=figure.get("slope_label"))
        axis.set_xlim(low, high)
        axis.set_ylim(limits)
    axis.set(title=figure["title"], xlabel=figure["x"], ylabel=figure["y"])
    axis.grid(True, which="major", color="#dddddd", linewidth=0.6)
    axis.set_axisbelow(True)
    if axis.get_legend_handles_labels()[0]:
        axis.legend(fontsize=7)
