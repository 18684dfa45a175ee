"""What is kept of a graph for each wind and kind of UAV."""

import gc
import weakref

import numpy as np
import pytest

from planning.energy import path_cost
from planning.energy.conditions import Conditions, WindLayer
from planning.energy.path_cost import NodeGround, graph_taken
from planning.rules import FlightRules
from tests.planning.energy.test_assignment_costs import HEAVY, IRIS, at, line_graph

RULES = FlightRules()
WINDY = Conditions((WindLayer(10, 5, 270),))


def test_sums_are_kept_for_the_same_wind_and_kind_of_uav_alone() -> None:
    graph = line_graph([at(0, 0), at(500, 0)], [45, 45])
    kept = graph_taken(graph, IRIS, WINDY, RULES, None)
    assert graph_taken(graph, IRIS, Conditions((WindLayer(10, 5, 270),)), RULES, None) is kept
    assert graph_taken(graph, HEAVY, WINDY, RULES, None) is not kept
    assert graph_taken(graph, IRIS, Conditions(), RULES, None) is not kept
    ground = NodeGround(np.array([400.0, 450.0]), np.zeros(0), np.zeros(0))
    assert graph_taken(graph, IRIS, WINDY, RULES, ground) is not kept


def test_beyond_their_room_the_sums_used_longest_ago_go_first(monkeypatch: pytest.MonkeyPatch) -> None:
    graph = line_graph([at(0, 0), at(500, 0)], [45, 45])
    iris = graph_taken(graph, IRIS, WINDY, RULES, None)
    monkeypatch.setattr(path_cost, "MAX_BYTES", 2 * iris.sums.nbytes)
    heavy = graph_taken(graph, HEAVY, WINDY, RULES, None)
    assert graph_taken(graph, IRIS, WINDY, RULES, None) is iris
    graph_taken(graph, IRIS, Conditions(), RULES, None)
    assert graph_taken(graph, IRIS, WINDY, RULES, None) is iris
    assert graph_taken(graph, HEAVY, WINDY, RULES, None) is not heavy


def test_sums_go_with_their_graph() -> None:
    graph = line_graph([at(0, 0), at(500, 0)], [45, 45])
    sums = weakref.ref(graph_taken(graph, IRIS, WINDY, RULES, None).sums.place)
    del graph
    gc.collect()
    assert sums() is None
