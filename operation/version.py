"""The running version: SPANWISE_VERSION, as set in an image, else the project's own."""

import os
import tomllib
from pathlib import Path


def _version() -> str:
    if reported := os.environ.get("SPANWISE_VERSION"):
        return reported[:64]
    try:
        project = tomllib.loads((Path(__file__).resolve().parent.parent / "pyproject.toml").read_text())
    except OSError:
        return "unknown"
    return str(project["project"]["version"])


VERSION = _version()
