"""New migrations leave room for the version before; see CONTRIBUTING.md."""

import importlib
import re
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest
from django.apps import apps
from django.core.checks import run_checks
from django.db import migrations, models

from tests.migration_rule import faults

PROJECT_DIR = Path(__file__).resolve().parents[1]
# Those of before the first version that was rolled out: the rule holds for all that come after.
BEFORE_THE_RULE = {"inspection": 1, "missions": 1, "results": 0, "simulation": 1, "telemetry": 1, "workspace": 1}
RELEASED = re.findall(r"^## \[?(\d+\.\d+\.\d+)", (PROJECT_DIR / "CHANGELOG.md").read_text(), flags=re.MULTILINE)


def later_migrations() -> list[str]:
    """Dotted names of those that the rule holds for."""
    found = []
    for app, last in BEFORE_THE_RULE.items():
        folder = Path(apps.get_app_config(app).path) / "migrations"
        found += [f"{app}.migrations.{path.stem}" for path in sorted(folder.glob("[0-9]*.py")) if int(path.stem[:4]) > last]
    return found


def test_the_version_before_can_go_on_beside_every_migration() -> None:
    reported = {name: faults(importlib.import_module(name), RELEASED) for name in later_migrations()}
    assert {name: found for name, found in reported.items() if found} == {}


def test_every_app_is_under_the_rule() -> None:
    with_migrations = {path.parent.name for path in PROJECT_DIR.glob("*/migrations")}
    assert with_migrations == BEFORE_THE_RULE.keys()


def migration(*operations: Any, **stated: str) -> ModuleType:
    found: Any = SimpleNamespace(Migration=SimpleNamespace(operations=list(operations)), **stated)
    return found  # type: ignore[no-any-return]


@pytest.mark.parametrize(
    "operation",
    [
        migrations.RemoveField("uav", "name"),
        migrations.DeleteModel("Uav"),
        migrations.RenameField("uav", "name", "label"),
        migrations.RenameModel("Uav", "Aircraft"),
        migrations.AddField("uav", "label", models.CharField(max_length=5, default="x")),
        migrations.RunSQL("ALTER TABLE missions_uav DROP COLUMN name"),
        migrations.SeparateDatabaseAndState(database_operations=[migrations.RemoveField("uav", "name")]),
    ],
)
def test_what_the_version_before_would_stumble_over_is_told(operation: Any) -> None:
    assert len(faults(migration(operation), ["1.0.0"])) == 1


@pytest.mark.parametrize(
    "operation",
    [
        migrations.AddField("uav", "label", models.CharField(max_length=5, null=True)),
        migrations.AddField("uav", "label", models.CharField(max_length=5, default="x", db_default="x")),
        migrations.CreateModel("Other", [("id", models.BigAutoField(primary_key=True))]),
        migrations.AddIndex("uav", models.Index(fields=["name"], name="by_name")),
        migrations.RunSQL("CREATE INDEX by_name ON missions_uav (name)"),
    ],
)
def test_what_only_adds_is_fine(operation: Any) -> None:
    assert faults(migration(operation), ["1.0.0"]) == []


def test_what_a_released_version_no_longer_used_may_go() -> None:
    operation = migrations.RemoveField("uav", "name")
    assert faults(migration(operation, UNUSED_SINCE="1.0.0"), ["1.0.0"]) == []
    assert faults(migration(operation, UNUSED_SINCE="9.9.9"), ["1.0.0"]) == ["UNUSED_SINCE names 9.9.9, which is not released yet"]


@pytest.mark.django_db
def test_the_checks_that_migrate_runs_find_nothing() -> None:
    assert [str(fault) for fault in run_checks(databases=["default"]) if fault.is_serious()] == []
