"""The soak as a picture: memory of each program, of all, connections and Redis over time."""

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from deploy.load.day.sampling import Sample

MIB = 2**20
mpl.rcParams |= {"svg.fonttype": "none", "svg.hashsalt": "spanwise", "font.family": "sans-serif", "font.size": 9.0}


def soak_picture(path: Path, samples: Sequence[Sample], warm_up_s: float, title: str) -> None:
    """SVG. Memory of each program as a share of what it was at the end of the warm-up, which is shaded."""
    first_s = samples[0].at_s
    minutes = np.array([(one.at_s - first_s) / 60.0 for one in samples])
    figure = Figure(figsize=(8.0, 7.5), layout="constrained")
    programs, whole, beside = figure.subplots(3, 1, sharex=True, height_ratios=(2, 1, 1))
    base = min(int(np.searchsorted(minutes, warm_up_s / 60.0)), len(samples) - 1)
    names = sorted(name for name in samples[-1].own_bytes if name != "redis")  # a few MiB, which would be all over the panel
    for number, name in enumerate(names):
        values = np.array([one.own_bytes.get(name, 0) for one in samples]) / MIB
        reference = values[base] or 1.0
        style = "-" if number < 10 else "--"  # the colours of a cycle come again
        programs.plot(minutes, 100.0 * values / reference, style, linewidth=1.0, label=f"{name} ({reference:.0f} MiB)")
    programs.set_ylabel("memory, % of after the warm-up")
    programs.set_ylim(90.0, 110.0)
    programs.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False, fontsize=7.5)
    whole.plot(minutes, [one.all_bytes / MIB for one in samples], color="#1f5fa8", label="all programs, MiB")
    whole.plot(minutes, [one.shared_bytes / MIB for one in samples], color="#808080", label="PostgreSQL's buffers, MiB")
    whole.set_ylim(bottom=0)
    beside.plot(minutes, [one.connections for one in samples], color="#c2571a", label="connections to PostgreSQL")
    beside.plot(minutes, [one.redis_bytes / MIB for one in samples], color="#3f7d3a", label="Redis, MiB")
    beside.plot(minutes, [one.waiting for one in samples], color="#808080", label="waiting in queues")
    beside.set_ylim(bottom=0)
    beside.set_xlabel("minutes")
    for panel in (programs, whole, beside):
        panel.axvspan(0.0, warm_up_s / 60.0, color="#f2f2f2")
        panel.grid(visible=True, color="#e4e4e4", linewidth=0.6)
        panel.spines[["top", "right"]].set_visible(False)
    for panel in (whole, beside):
        panel.legend(loc="center right", frameon=False, fontsize=7.5)
    figure.suptitle(title, fontsize=10)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, format="svg", metadata={"Date": None, "Creator": None}, facecolor="white")
    path.write_text("\n".join(line.rstrip() for line in path.read_text().splitlines()) + "\n")
