from django.db import migrations, models


class Migration(migrations.Migration):
    dependencies = [("inspection", "0009_search_by_voltage")]

    operations = [
        migrations.AlterField(
            model_name="proposedchange",
            name="action",
            field=models.CharField(
                choices=[
                    ("new", "New"),
                    ("changed", "Changed"),
                    ("vanished", "Vanished"),
                    ("kept", "Kept as edited by hand"),
                    ("not_read", "Not read"),
                ],
                max_length=20,
            ),
        ),
    ]
