"""The part of the inspection graph that a plan's height limit leaves."""

from inspection.network.build.flyable import flyable_part
from inspection.network.inspection_graph import InspectionGraph
from planning.rules import FlightRules


def flyable_graph(graph: InspectionGraph, rules: FlightRules) -> InspectionGraph:
    """The graph without nodes too tall to be flown over with clearance, and without their edges."""
    return flyable_part(graph, rules.tallest_m)
