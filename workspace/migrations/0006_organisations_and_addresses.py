"""A time zone of organisations, and the address of a session."""

from django.db import migrations, models


class Migration(migrations.Migration):
    dependencies = [("workspace", "0005_refused_sign_ins")]

    operations = [
        migrations.AddField(
            model_name="organisation",
            name="time_zone",
            field=models.CharField(
                blank=True,
                db_default="",
                default="",
                help_text="IANA name, for users who chose none; empty: the browser's",
                max_length=64,
            ),
        ),
        migrations.AddField(
            model_name="organisation",
            name="revision",
            field=models.PositiveIntegerField(db_default=1, default=1, editable=False, help_text="counts the changes; the ETag"),
        ),
        migrations.AddField(
            model_name="browsersession",
            name="address",
            field=models.GenericIPAddressField(blank=True, help_text="of the last request that was noted", null=True),
        ),
        migrations.AlterField(
            model_name="user",
            name="time_zone",
            field=models.CharField(
                blank=True, help_text="IANA name; empty: the organisation's, else the browser's", max_length=64
            ),
        ),
    ]
