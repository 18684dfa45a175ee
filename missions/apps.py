"""Django app configuration."""

from django.apps import AppConfig

from workspace.admin_pages.field_labels import label
from workspace.jobs.result_texts import register_result_texts


class MissionsConfig(AppConfig):
    name = "missions"

    def ready(self) -> None:
        label(self.get_models())
        from inspection.auto_apply_hooks import register_check  # noqa: PLC0415 (models are there by then)

        register_check("missions.selectors.flown_infrastructure.flown_missions_touched")
        from inspection.hooks import register_bases, register_deletion, register_inspected_shares, register_inspections  # noqa: PLC0415

        register_inspections("missions.selectors.missions.inspections_of_assets")
        register_inspected_shares("missions.selectors.line_inspections.inspected_shares")
        register_bases("missions.services.fleet.demo_uavs.positions_of_bases")
        register_deletion("missions.services.fleet.demo_uavs.delete_demo_uavs")
        register_result_texts("missions.tasks.solve_plan", "missions.reason_texts.plan_with_texts")
        register_result_texts("missions.proof_tasks.prove_mission", "missions.reason_texts.plan_with_texts")
