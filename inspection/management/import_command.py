"""Base of commands that read a file: the file, JSON on request, progress on a terminal, one sentence for a bad file."""

import json
import sys
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from django.core.management.base import BaseCommand, CommandError, CommandParser
from django.db import transaction

from inspection.models import MAX_REMOVED_PERCENT, DataImport, ImportProposal, ProposalState
from inspection.services.imports.uploads import PART_BYTES, UploadTooLarge, check_size_for, store_upload
from inspection.services.proposals import pipeline
from inspection.services.proposals.reading import KINDS
from inspection.tasks import send_job_of
from operation.reasons import Reason

Progress = Callable[[Reason | str, float], None]
LOOK_INTERVAL_S = 0.5
OPEN_STATES = (ProposalState.READING, ProposalState.APPLYING)


class ImportCommand(BaseCommand, ABC):
    """A subclass reads the file and returns the counts; it raises CommandError for a bad file."""

    kind: str

    def add_arguments(self, parser: CommandParser) -> None:
        parser.add_argument("file", type=Path, help="the file to read")
        parser.add_argument("--json", action="store_true", help="print the counts as JSON")
        parser.add_argument("--synthetic", action="store_true", help="the data are made up; it is said so wherever they are shown")
        if self.kind in KINDS:
            parser.add_argument(
                "--auto-apply",
                action="store_true",
                help="have the workers read it, and apply it only within bounds, as auto_apply of POST /api/v1/imports does; else it "
                "waits for a curator on the page of the imports, and the command fails with the reasons",
            )
            parser.add_argument(
                "--max-removed-percent",
                type=float,
                default=MAX_REMOVED_PERCENT,
                help="of the source's rows, for --auto-apply (%(default)s)",
            )

    def handle(self, *args: Any, **options: Any) -> None:
        path: Path = options["file"]
        if not path.is_file():
            raise CommandError(f"{path} is no file.")
        is_watched = sys.stderr.isatty()
        progress = self._show if is_watched else None
        try:
            data_import = self._within_bounds(path, options, progress) if options.get("auto_apply") else self.read(path, options, progress)
        except OSError as error:
            raise CommandError(f"{path.name} cannot be read: {error.strerror}") from error
        finally:
            if is_watched:
                self.stderr.write("\r\033[K", style_func=str, ending="")
        if options["json"]:
            self.stdout.write(json.dumps(data_import.counts))
        else:
            self.notify(path.name, data_import.counts)

    @abstractmethod
    def read(self, path: Path, options: dict[str, Any], progress: Progress | None) -> DataImport:
        """Store the file's content."""

    @abstractmethod
    def notify(self, name: str, counts: dict[str, Any]) -> None:
        """Print the content of the file for users."""

    def parameters(self, options: dict[str, Any]) -> dict[str, Any]:
        """Return the parameters of the proposal that --auto-apply makes, as in the API."""
        return {}

    def provenance(self, options: dict[str, Any]) -> dict[str, Any]:
        return {}

    def _within_bounds(self, path: Path, options: dict[str, Any], progress: Progress | None) -> DataImport:
        """Return the import that the workers have applied. Raises CommandError where they refuse the file or hold it back."""
        if options["synthetic"]:
            raise CommandError("--auto-apply is not for synthetic data.")
        if not 0.0 <= options["max_removed_percent"] <= 100.0:
            raise CommandError("--max-removed-percent is 0 to 100.")
        try:
            check_size_for(self.kind, path.stat().st_size)
        except UploadTooLarge as error:
            raise CommandError(str(error)) from error
        with transaction.atomic():
            proposal = pipeline.start_proposal(
                kind=self.kind, upload=store_upload(file_name=path.name, chunks=_parts(path), created_by=None), file_name=path.name,
                parameters=self.parameters(options), provenance=self.provenance(options), created_by=None, auto_apply=True,
                max_removed_percent=options["max_removed_percent"],
            )  # fmt: skip
            send_job_of(proposal)
        while proposal.state in OPEN_STATES:
            time.sleep(LOOK_INTERVAL_S)
            proposal = ImportProposal.objects.select_related("job", "data_import").get(pk=proposal.pk)
            if progress is not None and proposal.job is not None:
                progress(proposal.job.message, proposal.job.progress)
        if proposal.state == ProposalState.APPLIED and proposal.data_import is not None:
            return proposal.data_import
        reasons = [reason["message"] for reason in proposal.held_back] + [fault["message"] for fault in proposal.faults]
        listed = "".join(f"\n  {reason}" for reason in reasons)
        raise CommandError(f"{path.name} is not applied, it is {proposal.get_state_display().lower()} (/imports/{proposal.pk}):{listed}")

    def _show(self, stage: Reason | str, share: float) -> None:
        self.stderr.write(f"\r\033[K{share:4.0%} {stage}", style_func=str, ending="")


def _parts(path: Path) -> Iterator[bytes]:
    with path.open("rb") as file:
        while part := file.read(PART_BYTES):
            yield part
