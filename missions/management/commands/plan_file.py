"""Plan missions read from a file on a graph read from a file, without database and queue."""

import argparse
import json
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

from django.core.management import BaseCommand, CommandError, CommandParser

from planning.file_plans import PHASES, FileGraph, InvalidFile, plan_json, read_graph
from planning.problem import Objective

OBJECTIVES = {"sum": Objective.TOTAL, "max": Objective.MAKESPAN}


class Command(BaseCommand):
    help = "Plans the missions of a JSON file on the graph of an npz file; positions in both are lat, lon. See docs/performance.md."
    requires_system_checks: list[str] = []

    def add_arguments(self, parser: CommandParser) -> None:
        parser.formatter_class = argparse.ArgumentDefaultsHelpFormatter
        parser.add_argument("--graph", type=Path, required=True)
        parser.add_argument("--missions", type=Path, required=True)
        parser.add_argument("--json", type=Path, required=True, help="where the plans go")
        parser.add_argument("--objective", choices=sorted(OBJECTIVES), default="sum", help="the total of all routes, or the longest")

    def handle(self, *args: Any, **options: Any) -> None:
        try:
            missions = json.loads(options["missions"].read_bytes())
            if not isinstance(missions, list):
                raise InvalidFile("not a list of missions")
            began_s = perf_counter()
            with options["graph"].open("rb") as file:
                graph = read_graph(file)
            index_s = perf_counter() - began_s
            plans = self._plans(graph, missions, OBJECTIVES[options["objective"]])
            options["json"].write_bytes(b"[" + b",\n".join(plans) + b"]\n")
        except (OSError, InvalidFile, json.JSONDecodeError) as error:
            raise CommandError(str(error)) from error
        self.stdout.write(f"{graph.node_count:,} nodes read and indexed in {index_s:.2f} s; {len(plans)} plans")
        times = [json.loads(plan)["ms"] for plan in plans]
        for phase in (*PHASES, "total") if times else ():
            ms = [time[phase] for time in times]
            self.stdout.write(f"{phase:8} ms: min {min(ms):.4f} median {median(ms):.4f} max {max(ms):.4f}")

    def _plans(self, graph: FileGraph, missions: list[Any], objective: Objective) -> list[bytes]:
        if missions:
            plan_json(graph, missions[0], objective, perf_counter)  # loads the compiled code; planned again below
        return [plan_json(graph, mission, objective, perf_counter) for mission in missions]
