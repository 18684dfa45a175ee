"""What the commands that read a file have in common: the file, JSON on request, progress on a terminal, one sentence for a bad file."""

import json
import sys
from abc import ABC, abstractmethod
from collections.abc import Callable
from pathlib import Path
from typing import Any

from django.core.management.base import BaseCommand, CommandError, CommandParser

from inspection.models import DataImport

Progress = Callable[[str, float], None]


class ImportCommand(BaseCommand, ABC):
    """A subclass reads the file and tells the counts; its errors for a bad file are CommandErrors."""

    def add_arguments(self, parser: CommandParser) -> None:
        parser.add_argument("file", type=Path, help="the file to read")
        parser.add_argument("--json", action="store_true", help="print the counts as JSON")
        parser.add_argument("--synthetic", action="store_true", help="the data are made up; it is said so wherever they are shown")

    def handle(self, *args: Any, **options: Any) -> None:
        path: Path = options["file"]
        if not path.is_file():
            raise CommandError(f"{path} is no file.")
        is_watched = sys.stderr.isatty()
        try:
            data_import = self.read(path, options, self._show if is_watched else None)
        except OSError as error:
            raise CommandError(f"{path.name} cannot be read: {error.strerror}") from error
        finally:
            if is_watched:
                self.stderr.write("\r\033[K", style_func=str, ending="")
        if options["json"]:
            self.stdout.write(json.dumps(data_import.counts))
        else:
            self.tell(path.name, data_import.counts)

    @abstractmethod
    def read(self, path: Path, options: dict[str, Any], progress: Progress | None) -> DataImport:
        """Store the file's content."""

    @abstractmethod
    def tell(self, name: str, counts: dict[str, Any]) -> None:
        """Print for people what was in it."""

    def _show(self, stage: str, share: float) -> None:
        self.stderr.write(f"\r\033[K{share:4.0%} {stage}", style_func=str, ending="")
