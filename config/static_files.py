"""Static files under names that change with their content, so that browsers keep them for a year."""

import re
from typing import Any

from django.contrib.staticfiles.storage import ManifestStaticFilesStorage

MAX_CHAIN_LENGTH = 12  # imports in a row: one pass over all files for each
# Files whose imports are rewritten: our own modules and style sheets, and libraries of several modules. Other libraries are served
# unchanged, as searching them for imports takes most of the time. A library's files are named with and without lib/.
REWRITTEN_FOLDERS = ("js", "css", "lib/maplibre-gl", "maplibre-gl", "lib/three", "three")
# Imports as our own modules are formatted: at the start of a line, in double quotes. Django's patterns fit any format and take nine tenths
# of the time: they search for an end from each "import" on, including those in comments.
OWN_IMPORTS = [
    (re.compile(r'(?m)^(?P<matched>(?P<import>(?:import|export) (?:[^;"]*? from )?)"(?P<url>[./][^"]+)";)'), '%(import)s"%(url)s";'),
    (re.compile(r'(?P<matched>import\("(?P<url>[./][^"]+\.js)"\))'), 'import("%(url)s")'),
]


class HashedStaticFiles(ManifestStaticFilesStorage):
    """Django's storage, with the imports of our own modules rewritten. Before collectstatic has run, names are plain."""

    support_js_module_import_aggregation = True
    max_post_process_passes = MAX_CHAIN_LENGTH
    _patterns: dict[str, list[tuple[re.Pattern[str], str]]]  # Django's: by folder and extension, patterns and replacements

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._patterns = {
            f"{folder}/{extension}": patterns for folder in REWRITTEN_FOLDERS for extension, patterns in self._patterns.items()
        } | {"js/*.js": OWN_IMPORTS}

    def stored_name(self, name: str) -> str:
        if not self.hashed_files:
            return name
        return str(super().stored_name(name))
