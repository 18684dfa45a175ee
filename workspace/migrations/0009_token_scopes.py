"""What a token may be used for. Those that are there keep all that their owner's role has."""

from typing import Any

import django.contrib.postgres.fields
from django.db import migrations, models

SCOPES = [("read", "Read"), ("plan", "Plan"), ("fly", "Fly"), ("curate", "Curate"), ("administer", "Administer")]
OF_ROLE = {
    "viewer": ["read"],
    "operator": ["read", "plan", "fly"],
    "curator": ["read", "curate"],
    "administrator": ["read", "plan", "fly", "curate", "administer"],
}


def give_all_of_the_role(apps: Any, schema_editor: Any) -> None:
    tokens = apps.get_model("workspace", "ApiToken").objects.filter(scopes=None)
    for role, scopes in OF_ROLE.items():
        tokens.filter(user__role=role).update(scopes=scopes)


class Migration(migrations.Migration):
    dependencies = [("workspace", "0008_installation_operators")]

    operations = [
        migrations.AddField(
            model_name="apitoken",
            name="scopes",
            field=django.contrib.postgres.fields.ArrayField(
                base_field=models.CharField(choices=SCOPES, max_length=20),
                blank=True,
                help_text="empty: all that the role has",
                null=True,
                size=None,
            ),
        ),
        migrations.RunPython(give_all_of_the_role, migrations.RunPython.noop),
    ]
