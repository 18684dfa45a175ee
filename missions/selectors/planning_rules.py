"""The limits from the settings that a plan keeps, as one value."""

from django.conf import settings

from planning.context import PlanningRules


def planning_rules() -> PlanningRules:
    return PlanningRules(
        linking=settings.GRAPH_RULES,
        routing=settings.ROUTING_RULES,
        flight=settings.FLIGHT_RULES,
        zones=settings.ZONE_RULES,
        heights=settings.FLOWN_HEIGHTS,
        separation=settings.SEPARATION_RULES,
    )
