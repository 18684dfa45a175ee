"""Pictures of runs over time, as SVG with its words as text."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter, StrMethodFormatter
from numpy.typing import NDArray

Series = Mapping[str, NDArray[np.float64]]
COLOURS = ("#1f5fa8", "#c2571a", "#3f7d3a")
GREY = "#808080"
mpl.rcParams |= {"svg.fonttype": "none", "svg.hashsalt": "spanwise", "font.family": "sans-serif", "font.size": 9.0}


def _panels(number: int) -> tuple[Figure, list[Axes]]:
    figure = Figure(figsize=(8.0, 1.0 + 1.7 * number), layout="constrained")
    panels = figure.subplots(number, 1, sharex=True, squeeze=False)[:, 0]
    for panel in panels:
        panel.grid(visible=True, color="#e4e4e4", linewidth=0.6)
        panel.spines[["top", "right"]].set_visible(False)
    panels[-1].set_xlabel("seconds")
    return figure, list(panels)


def _times(panel: Axes) -> None:
    """Milliseconds over three decades or more, with room for the legend above."""
    panel.set_ylabel("answer, ms")
    panel.set_yscale("log")
    low, high = panel.get_ylim()
    panel.set_ylim(min(low, 5.0), max(high * 8, 5_000.0))
    panel.yaxis.set_major_formatter(StrMethodFormatter("{x:,.0f}"))
    panel.yaxis.set_minor_formatter(NullFormatter())
    panel.legend(loc="upper left", frameon=False, ncols=2)


def _save(figure: Figure, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, format="svg", metadata={"Date": None, "Creator": None}, facecolor="white")
    path.write_text("\n".join(line.rstrip() for line in path.read_text().splitlines()) + "\n")


def scenario_picture(path: Path, runs: Sequence[tuple[str, Series]], title: str) -> None:
    """Requests a second over the users, and median and 95th percentile of the answers' time, one colour a run.

    Of each run: its name, and at_s, users, plans_per_s, median_ms and p95_ms, each shape (n,).
    """
    figure, (rate, users, time) = _panels(3)
    for colour, (name, series) in zip(COLOURS, runs, strict=False):
        rate.plot(series["at_s"], series["plans_per_s"], color=colour, label=name)
        users.plot(series["at_s"], series["users"], color=colour)
        time.plot(series["at_s"], series["median_ms"], color=colour, label=f"{name}: median")
        time.plot(series["at_s"], series["p95_ms"], color=colour, linewidth=0.9, linestyle=":", label=f"{name}: 95 %")
    rate.set_ylabel("requests/s")
    users.set_ylabel("users")
    _times(time)
    rate.legend(loc="upper left", frameon=False)
    for panel in (rate, users):
        panel.set_ylim(bottom=0)
    figure.suptitle(title, fontsize=10)
    _save(figure, path)


def replicas_picture(path: Path, series: Series, title: str, *, replicas: Mapping[str, NDArray[np.float64]], signal: str) -> None:
    """How many replicas there were over the load, with the signal that they follow.

    `series` as for a scenario, with signal_at_s and signal; `replicas` by name of the program, shape (n, 2): at_s, how many.
    """
    figure, (load, signals, counts, time) = _panels(4)
    load.plot(series["at_s"], series["users"], color=GREY, label="users")
    load.plot(series["at_s"], series["plans_per_s"], color=COLOURS[0], label="requests/s")
    signals.plot(series["signal_at_s"], series["signal"], color=COLOURS[0])
    signals.axhline(1.0, color=GREY, linewidth=0.8)
    signals.set_ylabel(signal)
    for colour, (name, steps) in zip(COLOURS, replicas.items(), strict=False):
        counts.step(steps[:, 0], steps[:, 1], where="post", color=colour, label=name)
    counts.set_ylabel("replicas")
    time.plot(series["at_s"], series["median_ms"], color=COLOURS[0], label="median")
    time.plot(series["at_s"], series["p95_ms"], color=COLOURS[0], linewidth=0.9, linestyle=":", label="95 %")
    _times(time)
    for panel in (load, counts):
        panel.legend(loc="upper left", frameon=False)
    for panel in (load, signals, counts):
        panel.set_ylim(bottom=0)
    figure.suptitle(title, fontsize=10)
    _save(figure, path)
