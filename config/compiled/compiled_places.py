"""Cache location of a function's compiled code: by its path within the project, so that other checkouts can use it."""

import os
from pathlib import Path

from numba.core.caching import UserProvidedCacheLocator

from config.private_servers import PROJECT_DIR


class ProjectCacheLocator(UserProvidedCacheLocator):
    """numba's locator for NUMBA_CACHE_DIR, without the digest of the checkout's path in folder names.

    numba stores a digest of the function's own source file beside the code, and compares it.
    """

    @classmethod
    def get_suitable_cache_subpath(cls, py_file: str) -> str:
        folder = Path(os.path.abspath(py_file)).parent  # noqa: PTH100 - as in numba: links are not followed
        if folder.is_relative_to(PROJECT_DIR):
            return ".".join(folder.relative_to(PROJECT_DIR).parts)
        return str(super().get_suitable_cache_subpath(py_file))
