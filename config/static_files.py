"""Static files under names that change with their content, so that browsers keep them for a year."""

import re
from typing import Any

from django.contrib.staticfiles.storage import ManifestStaticFilesStorage

LONGEST_CHAIN = 12  # modules that import modules: one pass over all files for each step


class HashedStaticFiles(ManifestStaticFilesStorage):
    """Django's storage, with the imports of our own modules rewritten. Before collectstatic has run, names are plain."""

    support_js_module_import_aggregation = True
    max_post_process_passes = LONGEST_CHAIN

    def stored_name(self, name: str) -> str:
        if not self.hashed_files:
            return name
        return str(super().stored_name(name))

    def url_converter(self, name: str, *args: Any, **kwargs: Any) -> Any:
        """Libraries are served as they came: only our own modules and style sheets are looked into."""
        convert = super().url_converter(name, *args, **kwargs)
        if name.startswith(("js/", "css/", "lib/maplibre-gl/", "lib/three/")):
            return convert
        return _unchanged


def _unchanged(match: re.Match[str]) -> str:
    return match[0]
