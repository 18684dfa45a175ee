"""Simulated UAVs in real time: simulations, their vehicles, and changes in flight."""

import uuid

from django.conf import settings
from django.contrib.gis.db import models
from django.db.models import Q
from django.db.models.functions import Now
from django.utils.translation import gettext_lazy
from django.utils.translation import gettext_lazy as _

from missions.models import Mission, Uav
from workspace.models import Organisation


class SimulationState(models.TextChoices):
    WANTED = "wanted", _("Waits for a simulator")
    FLYING = "flying", _("In simulation")
    ENDED = "ended", _("Ended")
    FAILED = "failed", _("Failed")


class SimulatedAutopilotType(models.TextChoices):
    PX4 = "px4", "PX4"
    ARDUPILOT = "ardupilot", "ArduPilot"


PRESENT = (SimulationState.WANTED, SimulationState.FLYING)


class Simulation(models.Model):
    """Simulated UAVs with a common clock, for a mission or in the pool. A simulator flies it under a lease."""

    id = models.UUIDField(primary_key=True, default=uuid.uuid4, editable=False)
    organisation = models.ForeignKey(Organisation, on_delete=models.CASCADE, related_name="simulations")
    mission = models.ForeignKey(
        Mission, on_delete=models.CASCADE, null=True, blank=True, related_name="simulations", help_text="empty: of the pool"
    )
    speed = models.FloatField(default=1.0, help_text="simulated seconds a second")
    seed = models.PositiveIntegerField(default=7)
    state = models.CharField(max_length=10, choices=SimulationState.choices, default=SimulationState.WANTED)
    reason = models.CharField(max_length=40, blank=True, help_text="why it has ended or failed; see simulation/serializers/simulations.py")
    lifetime_ends_at = models.DateTimeField()
    end_wanted_at = models.DateTimeField(null=True, blank=True)
    ended_at = models.DateTimeField(null=True, blank=True)
    holder = models.CharField(max_length=120, blank=True, help_text="the simulator that flies it, and its run")
    lease_expires_at = models.DateTimeField(null=True, blank=True)
    restarts = models.PositiveIntegerField(default=0, help_text="how often a simulator was lost")
    step_timing = models.JSONField(db_column="pace", default=dict, help_text="how the clock was kept: steps, late ones, what has slipped")
    created_by = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, blank=True, related_name="simulations")
    created_at = models.DateTimeField(db_default=Now(), editable=False)

    class Meta:
        ordering = ["-created_at", "-pk"]
        constraints = [
            models.CheckConstraint(condition=Q(state__in=SimulationState.values), name="simulation_state_known"),
            models.CheckConstraint(condition=Q(speed__gt=0), name="simulation_speed_positive"),
        ]
        indexes = [
            models.Index(fields=["organisation", "-created_at"], name="simulation_newest_idx"),
            models.Index(fields=["state"], condition=Q(state__in=PRESENT), name="simulation_present_idx"),
        ]

    def __str__(self) -> str:
        return f"{self.mission or 'pool'} {self.created_at:%Y-%m-%d %H:%M}"

    @property
    def is_present(self) -> bool:
        return self.state in PRESENT


class SimulatedVehicle(models.Model):
    """One simulated UAV. A UAV of the fleet has at most one at a time, and a port belongs to one vehicle."""

    id = models.UUIDField(primary_key=True, default=uuid.uuid4, editable=False)
    simulation = models.ForeignKey(Simulation, on_delete=models.CASCADE, related_name="vehicles")
    sequence = models.PositiveSmallIntegerField(help_text="of a mission's: the UAV's place in it")
    uav = models.ForeignKey(
        Uav, on_delete=models.CASCADE, null=True, blank=True, related_name="simulated_vehicles", help_text="that it stands in for"
    )
    name = models.CharField(max_length=100)
    system_id = models.PositiveSmallIntegerField()
    autopilot_type = models.CharField(
        db_column="flavour", max_length=10, choices=SimulatedAutopilotType.choices, default=SimulatedAutopilotType.PX4
    )
    airframe = models.CharField(max_length=40, help_text="a code of simulation/flight/airframe.py")
    battery_wh = models.FloatField(null=True, blank=True, help_text="empty = the airframe's own")
    position = models.PointField(srid=4326, help_text="where it stands at first")
    ground_amsl_m = models.FloatField(null=True, blank=True, help_text="of the ground there; empty = of the terrain, or 0")
    heading_deg = models.FloatField(default=0.0)
    conditions = models.JSONField(help_text="the air that it flies in, and its battery at first; see rehearsing/weather_scenario.py")
    port = models.PositiveIntegerField(null=True, blank=True, help_text="UDP, at which it listens; empty: it talks to the gateway")
    state = models.CharField(max_length=10, choices=SimulationState.choices, default=SimulationState.WANTED)
    reason = models.CharField(max_length=40, blank=True)
    end_wanted_at = models.DateTimeField(null=True, blank=True, help_text="since when it alone is to be gone")
    restarts = models.PositiveIntegerField(default=0, help_text="how often it was put on the ground anew")
    reported = models.JSONField(default=dict, db_column="told", help_text="how it does, as its simulator said last")
    reported_at = models.DateTimeField(null=True, blank=True, db_column="told_at")

    class Meta:
        ordering = ["sequence"]
        constraints = [
            models.UniqueConstraint(fields=["simulation", "sequence"], name="simulated_vehicle_sequence"),
            models.UniqueConstraint(fields=["simulation", "system_id"], name="simulated_vehicle_system_id"),
            models.UniqueConstraint(fields=["uav"], condition=Q(state__in=PRESENT), name="simulated_vehicle_one_a_uav"),
            models.UniqueConstraint(fields=["port"], condition=Q(state__in=PRESENT), name="simulated_vehicle_one_a_port"),
            models.CheckConstraint(condition=Q(state__in=SimulationState.values), name="simulated_vehicle_state_known"),
            models.CheckConstraint(condition=Q(autopilot_type__in=SimulatedAutopilotType.values), name="simulated_vehicle_flavour_known"),
        ]

    def __str__(self) -> str:
        return self.name


class SimulationChange(models.Model):
    """A change of a simulation, applied once by its simulator."""

    simulation = models.ForeignKey(Simulation, on_delete=models.CASCADE, related_name="changes")
    vehicle = models.ForeignKey(SimulatedVehicle, on_delete=models.CASCADE, null=True, blank=True, related_name="changes")
    speed = models.FloatField(null=True, blank=True)
    conditions = models.JSONField(null=True, blank=True)
    faults = models.JSONField(null=True, blank=True, help_text="as simulation/flight/faults.py has them")
    created_by = models.ForeignKey(settings.AUTH_USER_MODEL, on_delete=models.SET_NULL, null=True, blank=True, related_name="+")
    created_at = models.DateTimeField(db_default=Now(), editable=False)
    done_at = models.DateTimeField(null=True, blank=True)

    class Meta:
        ordering = ["pk"]
        indexes = [models.Index(fields=["simulation"], condition=Q(done_at=None), name="simulation_change_open_idx")]

    def __str__(self) -> str:
        return f"{self.simulation_id} {self.created_at:%H:%M:%S}"


REASONS = {
    "": "",
    "ended-by-hand": gettext_lazy("Somebody ended it."),
    "lifetime-over": gettext_lazy("Its lifetime is over."),
    "mission-over": gettext_lazy("The mission is over."),
    "uav-changed": gettext_lazy("A UAV that it stood in for is no longer marked as simulated, or is reached in another way."),
    "simulator-lost": gettext_lazy("The simulator was lost while the UAV was in the air: the UAV is lost with it."),
    "simulator-fault": gettext_lazy("It failed inside Spanwise; the error is in the simulator's log."),
    "no-gateway": gettext_lazy("No gateway listens for MAVLink: SPANWISE_GATEWAY_UDP is empty, and SPANWISE_SIMULATOR_GATEWAY names none."),
    "no-socket": gettext_lazy("The simulator could not listen at its port."),
    "port-taken": gettext_lazy(
        "Another program on the simulator's machine has its port, such as another installation of Spanwise. Start it again, or give this "
        "installation ports of its own (SPANWISE_SIMULATOR_PORTS)."
    ),
}


def reason_words(code: str) -> str:
    return str(REASONS.get(code, code))
