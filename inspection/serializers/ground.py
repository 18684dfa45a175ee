"""The ground as a whole."""

from typing import Any

from rest_framework import serializers

from inspection.selectors import GroundSummary


class GraphSummarySerializer(serializers.Serializer):
    version = serializers.IntegerField()
    nodes = serializers.IntegerField()
    edges = serializers.IntegerField()
    built_at = serializers.DateTimeField()
    is_current = serializers.BooleanField(help_text="false while the ground has changed and the next graph is not yet built")


class GroundSerializer(serializers.Serializer):
    revision = serializers.IntegerField()
    graph = GraphSummarySerializer(allow_null=True)
    extent = serializers.ListField(child=serializers.FloatField(), allow_null=True, help_text="west, south, east, north")
    counts = serializers.DictField(child=serializers.IntegerField(), help_text="by kind of asset, and `zone`")
    attribution = serializers.ListField(child=serializers.CharField())
    is_synthetic = serializers.BooleanField(help_text="some of the data is made, not real")
    has_terrain = serializers.BooleanField()


def ground_json(summary: GroundSummary) -> dict[str, Any]:
    graph = summary.graph
    return {
        "revision": summary.revision,
        "graph": graph
        and {
            "version": graph.version,
            "nodes": graph.nodes,
            "edges": graph.edges,
            "built_at": graph.built_at,
            "is_current": summary.graph_is_current,
        },
        "extent": summary.extent,
        "counts": summary.counts,
        "attribution": summary.attribution,
        "is_synthetic": summary.is_synthetic,
        "has_terrain": summary.has_terrain,
    }
