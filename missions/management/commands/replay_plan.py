"""Plan again from a context file, without a database."""

import argparse
import json
from pathlib import Path
from time import perf_counter
from typing import Any

from django.core.management import BaseCommand, CommandError, CommandParser

from planning.context_file import NotAContextFile, read_context
from planning.plan_json import plan_to_json
from planning.planner import ZonesNotSettled, plan
from planning.progress import PlanProgress
from planning.request import InvalidRequest


class Command(BaseCommand):
    help = "Makes the plan of a file that write_plan_context has written, or that was kept of a plan that failed. Needs no database."
    requires_system_checks: list[str] = []

    def add_arguments(self, parser: CommandParser) -> None:
        parser.formatter_class = argparse.ArgumentDefaultsHelpFormatter
        parser.add_argument("file", type=Path)
        parser.add_argument("--json", type=Path, help="where the plan goes, in the shape of the API")
        parser.add_argument("--seed", type=int, default=7)
        parser.add_argument("--search-s", type=float, default=0.0, help="how long large plans are searched for")

    def handle(self, *args: Any, **options: Any) -> None:
        try:
            context, request = read_context(options["file"])
            began_s = perf_counter()
            made = plan(context, request, seed=options["seed"], search_s=options["search_s"], on_progress=self._notify)
        except (NotAContextFile, OSError, InvalidRequest, ZonesNotSettled) as error:
            raise CommandError(str(error)) from error
        found = plan_to_json(made)
        if options["json"] is not None:
            options["json"].write_text(json.dumps(found, indent=1))
        self.stdout.write(
            f"{len(request.targets) - len(made.unassigned)} of {len(request.targets)} targets, {found['total_length_m'] / 1_000:.1f} km, "
            f"{made.solver_calls} solver calls, {perf_counter() - began_s:.2f} s"
        )
        for item in found["unassigned"]:
            self.stdout.write(f"target {item['target']}: {item['reason']}. {item['message']}")

    def _notify(self, progress: PlanProgress) -> None:
        self.stderr.write(f"{100 * progress.share:3.0f} % {progress.message}")
