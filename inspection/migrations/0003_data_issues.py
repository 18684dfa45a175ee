"""Gaps are called data issues; tables, constraints and indexes keep the names that the version before knows."""

import django.db.models.deletion
from django.apps.registry import Apps
from django.db import migrations, models
from django.db.backends.base.schema import BaseDatabaseSchemaEditor

MODELS = {"datagap": "dataissue", "gapsearch": "dataissuesearch"}


def rename_content_types(apps: Apps, editor: BaseDatabaseSchemaEditor) -> None:
    """The admin's history names models by content types."""
    content_types = apps.get_model("contenttypes", "ContentType").objects.using(editor.connection.alias).filter(app_label="inspection")
    for old, new in MODELS.items():
        if not content_types.filter(model=new).exists():
            content_types.filter(model=old).update(model=new)


class Migration(migrations.Migration):
    dependencies = [("inspection", "0002_auto_apply"), ("contenttypes", "0002_remove_content_type_name")]

    operations = [
        migrations.SeparateDatabaseAndState(
            state_operations=[
                migrations.RenameModel("DataGap", "DataIssue"),
                migrations.AlterModelTable("dataissue", "inspection_datagap"),
                migrations.RenameModel("GapSearch", "DataIssueSearch"),
                migrations.AlterModelTable("dataissuesearch", "inspection_gapsearch"),
                migrations.AlterModelOptions("dataissuesearch", {"verbose_name_plural": "issue searches"}),
                migrations.AlterField(
                    "dataissue",
                    "asset",
                    models.ForeignKey(
                        blank=True,
                        null=True,
                        on_delete=django.db.models.deletion.CASCADE,
                        related_name="issues",
                        to="inspection.asset",
                    ),
                ),
            ]
        ),
        migrations.RunPython(rename_content_types, migrations.RunPython.noop),
    ]
