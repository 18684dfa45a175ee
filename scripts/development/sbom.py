"""A bill of materials (CycloneDX 1.5) of an image, from its installed packages.

python -m scripts.development.sbom --python --node package-lock.json --out sbom.cdx.json
python -m scripts.development.sbom --debian LIST --add-to sbom.cdx.json          (LIST: "name version architecture" a line)
"""

import argparse
import json
import sys
import tomllib
from collections.abc import Iterable
from importlib.metadata import distributions
from pathlib import Path
from typing import Any

from scripts.places import PROJECT_DIR

Component = dict[str, Any]
MAX_LICENCE_LENGTH = 100  # some packages put the whole text there


def python_components() -> list[Component]:
    """Return every distribution of this Python."""
    found = []
    for distribution in distributions():
        reported = distribution.metadata
        name = reported["Name"]
        licence = next(filter(None, (reported[field] for field in ("License-Expression", "License") if field in reported)), "")
        if not licence or len(licence) > MAX_LICENCE_LENGTH:
            classes = [entry.rpartition(":: ")[2] for entry in reported.get_all("Classifier") or [] if entry.startswith("License ::")]
            licence = ", ".join(classes)
        found.append(_component(name, distribution.version, f"pkg:pypi/{name.lower().replace('_', '-')}@{distribution.version}", licence))
    return found


def node_components(lock: Path) -> list[Component]:
    """Return the packages of the lock that pages load, without developer tools."""
    found = []
    for path, package in json.loads(lock.read_text())["packages"].items():
        if path and not package.get("dev"):
            name = path.rpartition("node_modules/")[2]
            found.append(_component(name, package["version"], f"pkg:npm/{name}@{package['version']}", str(package.get("license", ""))))
    return found


def debian_components(lines: Iterable[str]) -> list[Component]:
    found = []
    for line in lines:
        name, version, architecture = line.split()
        found.append(_component(name, version, f"pkg:deb/debian/{name}@{version}?arch={architecture}", ""))
    return found


def _component(name: str, version: str, address: str, licence: str) -> Component:
    component: Component = {"type": "library", "name": name, "version": version, "purl": address, "bom-ref": address}
    if licence.strip():
        component["licenses"] = [{"license": {"name": licence.strip()}}]
    return component


def document(components: Iterable[Component]) -> dict[str, Any]:
    """Return the bill, sorted by address."""
    project = tomllib.loads((PROJECT_DIR / "pyproject.toml").read_text())["project"]
    whole = {component["bom-ref"]: component for component in components}
    about = {"type": "application", "name": project["name"], "version": project["version"], "bom-ref": project["name"]}
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {"component": about | {"licenses": [{"license": {"id": project["license"]}}]}},
        "components": [whole[address] for address in sorted(whole)],
    }


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--python", action="store_true")
    parser.add_argument("--node", type=Path)
    parser.add_argument("--debian", type=Path)
    parser.add_argument("--add-to", type=Path)
    parser.add_argument("--out", type=Path)
    options = parser.parse_args(arguments)
    components: list[Component] = []
    if options.add_to:
        components += json.loads(options.add_to.read_text())["components"]
    if options.python:
        components += python_components()
    if options.node:
        components += node_components(options.node)
    if options.debian:
        components += debian_components(options.debian.read_text().splitlines())
    text = json.dumps(document(components), indent=1, ensure_ascii=False)
    if target := options.out or options.add_to:
        target.write_text(text)
    else:
        print(text)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
