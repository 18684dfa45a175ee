"""The ground of the load tests in an installation: made once, kept in its folder."""

import subprocess
import sys
import time
from pathlib import Path

from deploy.load.installation import Installation
from scripts.places import PROJECT_DIR

NODES = 200_000
LAST_WRITTEN = "password.txt"
GOOD_FOR_S = 6 * 86_400  # its tokens are good for a day longer


def ground_folder(installation: Installation) -> Path:
    """Where requests, tokens and the password are."""
    return installation.places.state / "ground"


def bring_ground(installation: Installation) -> Path:
    """The graph of benchmarks/network/make_graph.py with assets, accounts and requests, unless they are there. Returns their folder."""
    folder = ground_folder(installation)
    written = folder / LAST_WRITTEN
    if not written.exists() or time.time() - written.stat().st_mtime > GOOD_FOR_S:
        folder.mkdir(parents=True, exist_ok=True)
        graph = folder / "graph.npz"
        for command in (
            ["benchmarks/network/make_graph.py", "--nodes", str(NODES), "--out", str(graph)],
            ["deploy/load/prepare_ground.py", "--graph", str(graph)],
        ):
            subprocess.run([sys.executable, *command], cwd=PROJECT_DIR, env=installation.environment(), check=True)
    return folder
