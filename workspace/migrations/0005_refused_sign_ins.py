"""Sign-ins that the rules of single sign-on refuse: one more outcome. The version before writes only those that it knows."""

from django.db import migrations, models

KNOWN = ["signed-in", "wrong", "wrong-code", "held-back", "signed-out", "refused"]


class Migration(migrations.Migration):
    dependencies = [("workspace", "0004_any_language")]

    operations = [
        migrations.RemoveConstraint(model_name="signinentry", name="sign_in_outcome_known"),
        migrations.AlterField(
            model_name="signinentry",
            name="outcome",
            field=models.CharField(
                choices=[
                    ("signed-in", "Signed in"),
                    ("wrong", "Wrong name or password"),
                    ("wrong-code", "Wrong code"),
                    ("held-back", "Too many tries"),
                    ("signed-out", "Signed out"),
                    ("refused", "Refused after single sign-on"),
                ],
                max_length=12,
            ),
        ),
        migrations.AddConstraint(
            model_name="signinentry",
            constraint=models.CheckConstraint(condition=models.Q(("outcome__in", KNOWN)), name="sign_in_outcome_known"),
        ),
    ]
