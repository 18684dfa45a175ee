"""Static files under names that change with their content, so that browsers keep them for a year; of pages' own files their bundles."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from django.contrib.staticfiles.storage import ManifestStaticFilesStorage

from config import page_bundles

RECORD = "bundles.json"
SOURCES_OF_BUNDLES = ("js/", "css/pages/")
UNBUNDLED_SCRIPTS = ("js/early.js", "js/offline/service_worker.js", "js/locale/")


class StaticFiles(ManifestStaticFilesStorage):
    """Django's storage, with bundles in place of the modules and style sheets of pages. Before collectstatic has run, names are plain."""

    patterns = ()  # what is not in a bundle names no other file

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        record = self._record()
        self.chunks: dict[str, list[str]] = record.get("chunks", {})  # that the bundle of each source needs
        self.later: dict[str, list[str]] = record.get("later", {})  # that it loads itself

    def post_process(self, paths: dict[str, Any], dry_run: bool = False, **options: Any) -> Iterator[Any]:
        yield from super().post_process({name: found for name, found in paths.items() if not is_bundled(name)}, dry_run, **options)
        if dry_run:
            return
        root = Path(self.location)
        bundles, files = page_bundles.build(root)
        before = set(self._record().get("files", []))
        for path in (root / page_bundles.FOLDER).rglob("*.*"):  # those of the build before serve pages that are open
            if str(path.relative_to(root)) not in files | before:
                path.unlink()
        self.chunks = {name: bundle.chunks for name, bundle in bundles.items()}
        self.later = {name: bundle.later for name, bundle in bundles.items() if bundle.later}
        (root / RECORD).write_text(json.dumps({"chunks": self.chunks, "later": self.later, "files": sorted(files)}, indent=1))
        self.hashed_files |= {name: bundle.path for name, bundle in bundles.items()}
        self.save_manifest()

    def stored_name(self, name: str) -> str:
        if not self.hashed_files:
            return name
        return str(super().stored_name(name))

    def _record(self) -> dict[str, Any]:
        try:
            return dict(json.loads((Path(self.location) / RECORD).read_text()))
        except FileNotFoundError:
            return {}


def is_bundled(name: str) -> bool:
    return name.startswith(SOURCES_OF_BUNDLES) and not name.startswith(UNBUNDLED_SCRIPTS)
