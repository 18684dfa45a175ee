"""Whether the version before this one can go on while a migration has been applied, as it does during a rolling update.

What a migration may not do at once it does in two versions: the first one stops using it, the next one takes it away and says so in the
migration's module by `UNUSED_SINCE = "1.4.0"`, the released version that no longer used it.
"""

from collections.abc import Collection, Iterator
from types import ModuleType
from typing import Any

from django.db import migrations
from django.db.models import NOT_PROVIDED, ManyToManyField

TAKES_AWAY = (migrations.RemoveField, migrations.DeleteModel)
RENAMES = (migrations.RenameField, migrations.RenameModel, migrations.AlterModelTable)
WORDS_OF_SQL = ("DROP TABLE", "DROP COLUMN", "RENAME ", "SET NOT NULL", "ALTER TYPE", "SET DATA TYPE")


def faults(module: ModuleType, released: Collection[str]) -> list[str]:
    """What the version before would stumble over. `released` are the versions that are out."""
    since = getattr(module, "UNUSED_SINCE", None)
    if since is not None and since not in released:
        return [f"UNUSED_SINCE names {since}, which is not released yet"]
    return [fault for operation in _flat(module.Migration.operations) for fault in _faults_of(operation, is_unused=since is not None)]


def _flat(operations: list[Any]) -> Iterator[Any]:
    for operation in operations:
        if isinstance(operation, migrations.SeparateDatabaseAndState):
            yield from _flat(list(operation.database_operations))
        else:
            yield operation


def _faults_of(operation: Any, *, is_unused: bool) -> Iterator[str]:
    reported = operation.describe()
    if isinstance(operation, RENAMES):
        yield f"{reported}: the version before knows the old name alone; add the new one, fill it, and take the old one away later"
    elif isinstance(operation, TAKES_AWAY) and not is_unused:
        yield f"{reported}: the version before still uses it; UNUSED_SINCE is missing"
    elif isinstance(operation, migrations.AddField):
        field = operation.field
        is_optional = field.null or getattr(field, "db_default", NOT_PROVIDED) is not NOT_PROVIDED or isinstance(field, ManyToManyField)
        if not is_optional:
            yield f"{reported}: the version before adds rows without it; let it be null, or give it a db_default"
    elif isinstance(operation, migrations.RunSQL) and not is_unused:
        text = operation.sql if isinstance(operation.sql, str) else " ".join(str(part) for part in operation.sql)
        yield from (f"raw SQL says {word.strip()}" for word in WORDS_OF_SQL if word in text.upper())
