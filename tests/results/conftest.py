"""A media store and a folder of uploads of each test's own."""

from pathlib import Path
from typing import Any

import pytest


@pytest.fixture(autouse=True)
def media_folder(settings: Any, tmp_path: Path) -> Path:
    folder = tmp_path / "media"
    settings.UPLOAD_DIR = tmp_path / "uploads"
    settings.STORAGES = settings.STORAGES | {"media": settings.STORAGES["media"] | {"OPTIONS": {"location": str(folder)}}}
    return folder
