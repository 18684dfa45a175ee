import django.db.models.deletion
import django.db.models.functions.datetime
from django.conf import settings
from django.db import migrations, models


class Migration(migrations.Migration):
    dependencies = [
        ("workspace", "0003_roles_and_idempotency"),
    ]

    operations = [
        migrations.AddField(
            model_name="apitoken",
            name="last_used_at",
            field=models.DateTimeField(blank=True, help_text="to the minute", null=True),
        ),
        migrations.AddField(
            model_name="user",
            name="language",
            field=models.CharField(
                blank=True, choices=[("", "As the browser"), ("en", "English"), ("de", "Deutsch")], default="", max_length=5
            ),
        ),
        migrations.AddField(
            model_name="user",
            name="single_keys",
            field=models.BooleanField(default=True, help_text="shortcuts of one key on the pages"),
        ),
        migrations.AddField(
            model_name="user",
            name="theme",
            field=models.CharField(
                choices=[("system", "As the system"), ("light", "Light"), ("dark", "Dark")], default="system", max_length=10
            ),
        ),
        migrations.AddField(
            model_name="user",
            name="time_zone",
            field=models.CharField(blank=True, help_text="IANA name; empty: the browser's", max_length=64),
        ),
        migrations.AddField(
            model_name="user",
            name="units",
            field=models.CharField(
                choices=[("metric", "Metres, kilometres, metres per second"), ("imperial", "Feet, miles, miles per hour")],
                default="metric",
                help_text="what is shown; what is stored is metric",
                max_length=10,
            ),
        ),
        migrations.CreateModel(
            name="Invitation",
            fields=[
                ("id", models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name="ID")),
                (
                    "email",
                    models.EmailField(blank=True, help_text="where the link was sent; empty: handed over by other means", max_length=254),
                ),
                (
                    "role",
                    models.CharField(
                        choices=[
                            ("viewer", "Viewer"),
                            ("operator", "Operator"),
                            ("curator", "Curator"),
                            ("administrator", "Administrator"),
                        ],
                        default="viewer",
                        max_length=20,
                    ),
                ),
                ("token_sha256", models.CharField(editable=False, max_length=64, unique=True)),
                ("created_at", models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                ("expires_at", models.DateTimeField()),
                ("revoked_at", models.DateTimeField(blank=True, null=True)),
                ("accepted_at", models.DateTimeField(blank=True, null=True)),
                (
                    "accepted_by",
                    models.OneToOneField(
                        blank=True,
                        null=True,
                        on_delete=django.db.models.deletion.SET_NULL,
                        related_name="invitation",
                        to=settings.AUTH_USER_MODEL,
                    ),
                ),
                (
                    "invited_by",
                    models.ForeignKey(
                        blank=True,
                        null=True,
                        on_delete=django.db.models.deletion.SET_NULL,
                        related_name="invitations_sent",
                        to=settings.AUTH_USER_MODEL,
                    ),
                ),
                (
                    "organisation",
                    models.ForeignKey(
                        default=1, on_delete=django.db.models.deletion.CASCADE, related_name="invitations", to="workspace.organisation"
                    ),
                ),
            ],
            options={
                "ordering": ["-created_at"],
                "constraints": [
                    models.CheckConstraint(
                        condition=models.Q(("role__in", ["viewer", "operator", "curator", "administrator"])), name="invitation_role_known"
                    )
                ],
            },
        ),
        migrations.CreateModel(
            name="SignInEntry",
            fields=[
                ("id", models.BigAutoField(auto_created=True, primary_key=True, serialize=False, verbose_name="ID")),
                (
                    "outcome",
                    models.CharField(
                        choices=[
                            ("signed-in", "Signed in"),
                            ("wrong", "Wrong name or password"),
                            ("held-back", "Too many tries"),
                            ("signed-out", "Signed out"),
                        ],
                        max_length=12,
                    ),
                ),
                ("address", models.CharField(blank=True, help_text="IP address", max_length=45)),
                ("user_agent", models.CharField(blank=True, max_length=200)),
                ("recorded_at", models.DateTimeField(db_default=django.db.models.functions.datetime.Now(), editable=False)),
                (
                    "user",
                    models.ForeignKey(
                        blank=True,
                        null=True,
                        on_delete=django.db.models.deletion.CASCADE,
                        related_name="sign_ins",
                        to=settings.AUTH_USER_MODEL,
                    ),
                ),
            ],
            options={
                "verbose_name_plural": "sign-in entries",
                "ordering": ["-recorded_at", "-pk"],
                "indexes": [
                    models.Index(fields=["-recorded_at", "-id"], name="sign_in_newest_idx"),
                    models.Index(fields=["user", "-recorded_at"], name="sign_in_of_user_idx"),
                ],
                "constraints": [
                    models.CheckConstraint(
                        condition=models.Q(("outcome__in", ["signed-in", "wrong", "held-back", "signed-out"])), name="sign_in_outcome_known"
                    )
                ],
            },
        ),
    ]
