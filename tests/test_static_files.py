"""Static files under names that change with their content."""

import json
import re
from pathlib import Path

import pytest
from django.contrib.staticfiles.storage import staticfiles_storage
from django.core.management import call_command

from config.static_files import HashedStaticFiles

IMPORTED = re.compile(r"""(?:\bfrom|\bimport\(|^import)\s*["']([./][^"']+)["']""", re.M)
HASHED = re.compile(r"\.[0-9a-f]{12}\.\w+$")


def imports_of(module: Path) -> list[str]:
    """Addresses that a module imports; those in comments are of types alone."""
    return IMPORTED.findall(re.sub(r"/\*.*?\*/", "", module.read_text(), flags=re.S))


@pytest.fixture(scope="module")
def collected(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("static")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("django.conf.settings.STATIC_ROOT", folder)
        patch.setattr(staticfiles_storage, "_wrapped", HashedStaticFiles(location=folder, base_url="/static/"))
        call_command("collectstatic", interactive=False, verbosity=0)
    return folder


def test_every_module_imports_hashed_names_alone(collected: Path) -> None:
    names = json.loads((collected / "staticfiles.json").read_text())["paths"]
    modules = [collected / hashed for name, hashed in names.items() if name.startswith("js/") and name.endswith(".js")]
    assert len(modules) > 50
    plain = {f"{module.name}: {found}" for module in modules for found in imports_of(module) if not HASHED.search(found)}
    assert plain == set()


def test_every_imported_module_is_there(collected: Path) -> None:
    for module in collected.glob("js/**/*.????????????.js"):
        for found in imports_of(module):
            target = collected / found.removeprefix("/static/") if found.startswith("/") else (module.parent / found)
            assert target.exists(), f"{module.name} imports {found}"


def test_before_files_are_collected_names_are_plain(tmp_path: Path) -> None:
    storage = HashedStaticFiles(location=tmp_path, base_url="/static/")
    assert storage.url("js/api.js") == "/static/js/api.js"
