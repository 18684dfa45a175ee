"""Simulations in the API: simulated UAVs in real time."""

from collections.abc import Mapping
from typing import Any

from django.conf import settings
from django.utils.translation import gettext_lazy
from drf_spectacular.utils import extend_schema_field

from missions.fields import PositionField
from missions.serializers.known_fields import KnownFieldsSerializer
from simulation.flight.airframe import AIRFRAMES
from simulation.flight.faults import WrongFaults, faults_from
from simulation.models import SimulatedAutopilotType, SimulatedVehicle, Simulation, SimulationState
from simulation.serializers.shapes import RehearsalConditionsSerializer
from simulation.vehicle_models import reason_words
from workspace.api import strict_serializers as serializers

SPEEDS = (1, 2, 5, 10)
MAX_POOL_UAVS = 100
MAX_SYSTEM_ID = 250
MIN_LIFETIME_S, USUAL_LIFETIME_S, MAX_LIFETIME_S = 60, 3_600, 7 * 86_400


NOT_OF_THE_FLEET = gettext_lazy(
    "UAVs of the pool are not of the fleet. A UAV of the fleet that is marked as simulated is flown with a mission: start "
    "its simulated flight."
)


@extend_schema_field({"oneOf": [{"type": "string"}, {"type": "object", "additionalProperties": {}}]})
class ConditionsField(serializers.JSONField):
    """A name or an object; parsed by simulation.views.rehearsals."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)


class FaultsSerializer(KnownFieldsSerializer):
    """Faults from now on; omitted ones stay unchanged."""

    link_lost_for_s = serializers.FloatField(required=False, min_value=0, max_value=86_400, help_text="silence both ways; 0: none")
    gps_lost_for_s = serializers.FloatField(required=False, min_value=0, max_value=86_400, help_text="no fix; 0: no longer")
    battery_wh_left = serializers.FloatField(
        required=False, allow_null=True, min_value=0, max_value=10_000, help_text="what the battery holds from now on"
    )
    motor_failed = serializers.IntegerField(
        required=False, allow_null=True, min_value=0, max_value=3, help_text="a rotor stands still; null: none"
    )
    stuck_item = serializers.IntegerField(
        required=False, allow_null=True, min_value=0, max_value=100_000, help_text="a mission item that is never done; null: none"
    )
    clock_offset_s = serializers.FloatField(
        required=False, min_value=-1e9, max_value=1e9, help_text="added to its idea of the time of day; 0: none"
    )

    def validate(self, attrs: dict[str, Any]) -> dict[str, Any]:
        try:
            faults_from(attrs)
        except WrongFaults as error:
            raise serializers.ValidationError(str(error)) from error
        return attrs


CONDITION_FIELDS = (
    "calm, as-planned, strong-wind, weak-battery, or an object with own figures as in rehearsals: name, wind, temperature_c, gusts_mps, "
    "turbulence_mps_at_20ft, battery_percent"
)


class VehicleChangeSerializer(KnownFieldsSerializer):
    conditions = ConditionsField(required=False, help_text=f"the air from now on: {CONDITION_FIELDS}; batteries stay as they are")
    faults = FaultsSerializer(required=False)

    def validate(self, attrs: dict[str, Any]) -> dict[str, Any]:
        if not attrs:
            raise serializers.ValidationError("Something to change is needed.")
        return attrs


class SimulationChangeSerializer(VehicleChangeSerializer):
    speed = serializers.ChoiceField(choices=SPEEDS, required=False, help_text="times real time, of all its UAVs")


class SimulatedFlightsInputSerializer(KnownFieldsSerializer):
    speed = serializers.ChoiceField(choices=SPEEDS, default=1, help_text="times real time")
    conditions = ConditionsField(default="as-planned", help_text=CONDITION_FIELDS)
    faults = FaultsSerializer(required=False)
    autopilot_type = serializers.ChoiceField(choices=SimulatedAutopilotType.choices, default=SimulatedAutopilotType.PX4)
    seed = serializers.IntegerField(min_value=0, max_value=1_000_000, default=7, help_text="of gusts and turbulence")


class PoolUavSerializer(KnownFieldsSerializer):
    position = PositionField()
    name = serializers.CharField(max_length=60, allow_blank=True, default="")
    heading_deg = serializers.FloatField(min_value=0, max_value=360, default=0.0)
    ground_amsl_m = serializers.FloatField(
        min_value=-500, max_value=9_000, allow_null=True, default=None, help_text="of the ground there, where no terrain model tells it"
    )

    def to_internal_value(self, data: Any) -> Any:
        if isinstance(data, Mapping) and "uav" in data:
            raise serializers.ValidationError({"uav": [NOT_OF_THE_FLEET]})
        return super().to_internal_value(data)


class SimulationInputSerializer(KnownFieldsSerializer):
    uavs: serializers.ListSerializer[Any] = serializers.ListSerializer(child=PoolUavSerializer(), min_length=1, max_length=MAX_POOL_UAVS)
    lifetime_s = serializers.IntegerField(
        min_value=MIN_LIFETIME_S,
        max_value=MAX_LIFETIME_S,
        default=USUAL_LIFETIME_S,
        help_text="then they end",
    )
    airframe = serializers.ChoiceField(choices=sorted(AIRFRAMES), default="iris", help_text="GET /airframes lists them")
    autopilot_type = serializers.ChoiceField(choices=SimulatedAutopilotType.choices, default=SimulatedAutopilotType.PX4)
    speed = serializers.ChoiceField(choices=SPEEDS, default=1)
    conditions = ConditionsField(default="calm", help_text=CONDITION_FIELDS)
    faults = FaultsSerializer(required=False)
    first_system_id = serializers.IntegerField(min_value=1, max_value=MAX_SYSTEM_ID, default=1, help_text="the others' follow")
    seed = serializers.IntegerField(min_value=0, max_value=1_000_000, default=7)

    def validate(self, attrs: dict[str, Any]) -> dict[str, Any]:
        if attrs["first_system_id"] + len(attrs["uavs"]) - 1 > MAX_SYSTEM_ID:
            raise serializers.ValidationError({"first_system_id": f"System ids end at {MAX_SYSTEM_ID}."})
        return attrs


class SimulatedUavSerializer(serializers.Serializer):
    id = serializers.IntegerField()
    name = serializers.CharField()


class ExampleSerializer(serializers.Serializer):
    program = serializers.CharField()
    command = serializers.CharField(help_text="or what to enter")


class ConnectSerializer(serializers.Serializer):
    protocol = serializers.CharField(help_text="udp: the UAV listens, and talks to whoever talked to it")
    host = serializers.CharField()
    port = serializers.IntegerField()
    examples = ExampleSerializer(many=True)


class VehicleReportSerializer(serializers.Serializer):
    at = serializers.DateTimeField()
    at_s = serializers.FloatField(help_text="simulated seconds since it was put on the ground")
    position = serializers.ListField(child=serializers.FloatField(), min_length=2, max_length=2, help_text="where it truly is")
    altitude_relative_m = serializers.FloatField()
    battery_percent = serializers.FloatField()
    mode = serializers.CharField()
    is_armed = serializers.BooleanField()
    is_in_air = serializers.BooleanField()
    is_crashed = serializers.BooleanField()
    is_link_lost = serializers.BooleanField(help_text="by a fault that was asked for")


class SimulatedVehicleSerializer(serializers.Serializer):
    id = serializers.UUIDField()
    simulation = serializers.UUIDField()
    is_simulated = serializers.BooleanField(help_text="always true")
    sequence = serializers.IntegerField(help_text="of a mission's: the UAV's place in it")
    uav = SimulatedUavSerializer(allow_null=True, help_text="of the fleet, that it stands in for")
    name = serializers.CharField()
    system_id = serializers.IntegerField()
    autopilot_type = serializers.ChoiceField(choices=SimulatedAutopilotType.choices)
    airframe = serializers.CharField()
    battery_wh = serializers.FloatField(help_text="of a full battery")
    position = serializers.ListField(child=serializers.FloatField(), min_length=2, max_length=2, help_text="where it was put")
    state = serializers.ChoiceField(choices=SimulationState.choices)
    reason = serializers.CharField(help_text="why it has ended or failed, for programs")
    message = serializers.CharField(help_text="the reason in words")
    restarts = serializers.IntegerField(help_text="how often it was put on the ground anew because its simulator was lost")
    conditions = RehearsalConditionsSerializer()
    report = VehicleReportSerializer(allow_null=True, help_text="how it does, to the second")
    connect = ConnectSerializer(allow_null=True, help_text="of the pool's: how ground stations reach it; others talk to the gateway")


class StepTimingSerializer(serializers.Serializer):
    simulated_s = serializers.FloatField()
    steps = serializers.IntegerField()
    late_steps = serializers.IntegerField(help_text="that began more than a step too late")
    latest_s = serializers.FloatField()
    slipped_s = serializers.FloatField(help_text="of real time, never made up for: too many UAVs, or too fast, for this machine")


class SimulationSerializer(serializers.Serializer):
    id = serializers.UUIDField()
    is_simulated = serializers.BooleanField(help_text="always true: nothing of this is flown by an aircraft")
    mission = serializers.UUIDField(allow_null=True, help_text="whose UAVs are stood in for; null: of the pool")
    state = serializers.ChoiceField(choices=SimulationState.choices)
    reason = serializers.CharField()
    message = serializers.CharField()
    speed = serializers.FloatField(help_text="times real time")
    seed = serializers.IntegerField()
    created_at = serializers.DateTimeField()
    created_by = serializers.CharField(allow_null=True)
    lifetime_ends_at = serializers.DateTimeField()
    ended_at = serializers.DateTimeField(allow_null=True)
    restarts = serializers.IntegerField(help_text="how often its simulator was lost")
    step_timing = StepTimingSerializer(allow_null=True)
    vehicles = SimulatedVehicleSerializer(many=True)


class SimulationPageSerializer(serializers.Serializer):
    results = SimulationSerializer(many=True)
    next = serializers.CharField(allow_null=True)


REPORTED_FIELDS = tuple(name for name in VehicleReportSerializer().get_fields() if name != "at")


def simulation_json(simulation: Simulation) -> dict[str, Any]:
    return {
        "id": str(simulation.pk),
        "is_simulated": True,
        "mission": None if simulation.mission_id is None else str(simulation.mission_id),
        "state": simulation.state,
        "reason": simulation.reason,
        "message": reason_words(simulation.reason),
        "speed": simulation.speed,
        "seed": simulation.seed,
        "created_at": simulation.created_at,
        "created_by": simulation.created_by.username if simulation.created_by else None,
        "lifetime_ends_at": simulation.lifetime_ends_at,
        "ended_at": simulation.ended_at,
        "restarts": simulation.restarts,
        "step_timing": simulation.step_timing or None,
        "vehicles": [vehicle_json(vehicle) for vehicle in simulation.vehicles.all()],
    }


def vehicle_json(vehicle: SimulatedVehicle) -> dict[str, Any]:
    reported = {name: vehicle.reported[name] for name in REPORTED_FIELDS if name in vehicle.reported}
    airframe = AIRFRAMES.get(vehicle.airframe)
    own_wh = 0.0 if airframe is None else airframe.battery_wh
    return {
        "id": str(vehicle.pk),
        "simulation": str(vehicle.simulation_id),
        "is_simulated": True,
        "sequence": vehicle.sequence,
        "uav": None if vehicle.uav is None else {"id": vehicle.uav_id, "name": vehicle.uav.name},
        "name": vehicle.name,
        "system_id": vehicle.system_id,
        "autopilot_type": vehicle.autopilot_type,
        "airframe": vehicle.airframe,
        "battery_wh": own_wh if vehicle.battery_wh is None else vehicle.battery_wh,
        "position": list(vehicle.position.coords),
        "state": vehicle.state,
        "reason": vehicle.reason,
        "message": reason_words(vehicle.reason),
        "restarts": vehicle.restarts,
        "conditions": vehicle.conditions,
        "report": {"at": vehicle.reported_at, **reported} if reported else None,
        "connect": None if vehicle.port is None else connection_json(settings.SIMULATOR_HOST, vehicle.port),
    }


def connection_json(host: str, port: int) -> dict[str, Any]:
    """Return how to connect: the UAV listens, and the ground station sends first."""
    examples = {
        "QGroundControl": f"Application Settings > Comm Links > Add: type UDP, server address {host}:{port}",
        "MAVProxy": f"mavproxy.py --master=udpout:{host}:{port} --source-system=255",
        "MAVSDK": f"udpout://{host}:{port}",
    }
    return {
        "protocol": "udp", "host": host, "port": port,
        "examples": [{"program": program, "command": command} for program, command in examples.items()],
    }  # fmt: skip
