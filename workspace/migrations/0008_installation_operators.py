"""The first administrator of an installation with one organisation operates it; with several, `manage.py installation_operator` says who."""

from typing import Any

from django.db import migrations, models


def name_the_first(apps: Any, schema_editor: Any) -> None:
    organisations, users = apps.get_model("workspace", "Organisation"), apps.get_model("workspace", "User")
    if organisations.objects.count() == 1:
        first = users.objects.filter(role="administrator", is_active=True).order_by("pk").values_list("pk", flat=True).first()
        users.objects.filter(pk=first).update(is_installation_operator=True)


class Migration(migrations.Migration):
    dependencies = [("workspace", "0007_second_factors_and_sessions")]

    operations = [
        migrations.AddField(
            model_name="user",
            name="is_installation_operator",
            field=models.BooleanField(
                db_default=False, default=False, editable=False, help_text="as administrator: of all organisations, in the admin"
            ),
        ),
        migrations.RunPython(name_the_first, migrations.RunPython.noop),
    ]
