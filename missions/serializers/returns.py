"""RTL behaviour of autopilots in the shapes of the API."""

from rest_framework import serializers

from missions.services.commands.rtl_check import ReturnState


class ReturnCheckSerializer(serializers.Serializer):
    place = serializers.IntegerField(help_text="the UAV's in the mission")
    name = serializers.CharField()
    uav = serializers.IntegerField(allow_null=True)
    state = serializers.ChoiceField(choices=[state.value for state in ReturnState])
    warnings = serializers.ListField(child=serializers.CharField(), help_text="what an operator must know; none where all is clear")
    parameter = serializers.CharField(allow_null=True, help_text="of the vehicle, that sets the height")
    height_m = serializers.FloatField(allow_null=True, help_text="above the take-off, as that parameter was read")
    safe_height_m = serializers.FloatField(allow_null=True, help_text="at which nothing would be in the way; null: none, or it is clear")
    read_at = serializers.DateTimeField(allow_null=True)
    fence_warning = serializers.CharField(
        allow_blank=True,
        help_text="that its autopilot ignores the fence of the mission; empty: it does not, or is not known to",
    )
    detail = serializers.CharField(
        allow_blank=True, help_text="parameters of the autopilot that were not read, for whoever sets it up; empty: none"
    )


class ReturnChecksSerializer(serializers.Serializer):
    results = ReturnCheckSerializer(many=True)
