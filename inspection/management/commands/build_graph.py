"""manage.py build_graph: build the inspection graph of the current map data."""

import json
import sys
from typing import Any

from django.core.management.base import BaseCommand, CommandParser

from inspection import services


class Command(BaseCommand):
    help = "Build the inspection graph, unless the newest one already shows the present assets and zones."

    def add_arguments(self, parser: CommandParser) -> None:
        parser.add_argument("--force", action="store_true", help="build a new version even if nothing has changed")
        parser.add_argument("--json", action="store_true", dest="as_json", help="print the figures as one JSON object")

    def handle(self, *args: Any, force: bool, as_json: bool, **options: Any) -> None:
        snapshot = services.build_graph(force=force, progress=self._notify)
        figures = {
            name: getattr(snapshot, name)
            for name in ("version", "nodes", "edges", "components", "excluded_nodes", "excluded_edges", "build_s")
        }
        if as_json:
            self.stdout.write(json.dumps(figures))
        else:
            self.stdout.write(
                "Graph {version}: {nodes} nodes, {edges} edges, {components} components; "
                "{excluded_nodes} nodes and {excluded_edges} edges are out because of zones; built in {build_s:.1f} s.".format(**figures)
            )

    def _notify(self, message: str, fraction: float) -> None:
        if sys.stderr.isatty():
            self.stderr.write(f"{fraction:4.0%} {message}")
