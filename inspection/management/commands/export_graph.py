"""manage.py export_graph: write a graph to a file for other programs."""

import json
import os
import sys
from pathlib import Path
from typing import Any, BinaryIO

import networkx as nx
from django.core.management.base import BaseCommand, CommandError, CommandParser

from inspection import selectors
from inspection.network.export import geojson_features, to_networkx
from inspection.network.inspection_graph import InspectionGraph
from inspection.network.snapshot_file import to_bytes


class Command(BaseCommand):
    help = "Write the newest inspection graph, or a given version, to a file or to standard output."

    def create_parser(self, prog_name: str, subcommand: str, **kwargs: Any) -> CommandParser:
        return super().create_parser(prog_name, subcommand, conflict_handler="resolve", **kwargs)  # --version is Django's own

    def add_arguments(self, parser: CommandParser) -> None:
        parser.add_argument("file", type=Path, nargs="?", help="standard output when left out")
        parser.add_argument("--format", choices=sorted(WRITERS), default="npz", dest="file_format")
        parser.add_argument("--version", type=int, dest="graph_version", metavar="N", help="of the graph; the newest when left out")

    def handle(self, *args: Any, file: Path | None, file_format: str, graph_version: int | None, **options: Any) -> None:
        try:
            graph = selectors.current_graph() if graph_version is None else selectors.graph_of_version(graph_version)
        except selectors.NoGraph as error:
            raise CommandError("There is no such graph. Build one with: manage.py build_graph") from error
        if file is None:
            WRITERS[file_format](graph, sys.stdout.buffer)
            return
        draft = file.with_name(f".{file.name}.{os.getpid()}")
        try:
            with draft.open("wb") as stream:
                WRITERS[file_format](graph, stream)
            draft.replace(file)
        except OSError as error:
            raise CommandError(f"{file} cannot be written: {error.strerror}") from error
        finally:
            draft.unlink(missing_ok=True)
        self.stdout.write(f"Graph {graph.version}: {graph.node_count} nodes and {graph.edge_count} edges written to {file}")


def _write_npz(graph: InspectionGraph, stream: BinaryIO) -> None:
    stream.write(to_bytes(graph))


def _write_graphml(graph: InspectionGraph, stream: BinaryIO) -> None:
    nx.write_graphml(to_networkx(graph), stream)


def _write_geojson(graph: InspectionGraph, stream: BinaryIO) -> None:
    stream.write(b'{"type": "FeatureCollection", "features": [')
    for number, feature in enumerate(geojson_features(graph)):
        stream.write((",\n" if number else "\n").encode() + json.dumps(feature).encode())
    stream.write(b"\n]}\n")


WRITERS = {"npz": _write_npz, "graphml": _write_graphml, "geojson": _write_geojson}
