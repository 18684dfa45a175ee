"""Accounts for programs, in which nobody signs in."""

from django.db import migrations, models
from django.db.models import Q


class Migration(migrations.Migration):
    dependencies = [("workspace", "0009_token_scopes")]

    operations = [
        migrations.AddField(
            model_name="user",
            name="is_service",
            field=models.BooleanField(db_default=False, default=False, editable=False, help_text="of a program: nobody signs in with it"),
        ),
        migrations.AddConstraint(
            model_name="user",
            constraint=models.CheckConstraint(
                condition=Q(is_service=False) | Q(password__startswith="!", is_installation_operator=False), name="service_without_password"
            ),
        ),
    ]
