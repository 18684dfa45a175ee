"""Lets a UAV's credential count until the newer one was used."""

from django.db import migrations, models
from django.db.models import Q


class Migration(migrations.Migration):
    dependencies = [("missions", "0027_demo_data")]

    operations = [
        migrations.AddField(
            model_name="uavcredential",
            name="replaced_at",
            field=models.DateTimeField(blank=True, help_text="a newer one was made; this one counts until that was used", null=True),
        ),
        migrations.RemoveConstraint(model_name="uavcredential", name="uav_credential_one_in_force"),
        migrations.AddConstraint(
            model_name="uavcredential",
            constraint=models.UniqueConstraint(
                condition=Q(replaced_at=None, revoked_at=None), fields=("uav", "kind"), name="uav_credential_one_newest"
            ),
        ),
    ]
