"""Options of a simulator."""

from dataclasses import dataclass

from django.conf import settings

from simulation.vehicle_endpoint.radio import Address, address_of
from workspace.leases import HolderOptions, holder_name


@dataclass(frozen=True, kw_only=True)
class SimulatorOptions(HolderOptions):
    """Capacity of a simulator, and where its UAVs connect.

    `most_load`: maximum simulated seconds per second, over all UAVs. `gateway`: where a mission's UAVs connect, None without one. `host`:
    where the pool's UAVs listen.
    """

    most_load: float
    gateway: Address | None
    host: str


def options_of_settings(*, name: str | None = None, most_uavs: int | None = None, gateway: str | None = None) -> SimulatorOptions:
    """Return the options; without a name one is made for this process. Raises InvalidStationAddress."""
    reached_at = gateway or settings.SIMULATOR_GATEWAY or settings.GATEWAY_UDP.split(",")[0]
    return SimulatorOptions(
        name=holder_name(name or settings.SIMULATOR_NAME),
        most_load=float(settings.SIMULATOR_MAX_UAVS if most_uavs is None else most_uavs),
        gateway=gateway_address(reached_at) if reached_at else None,
        host=settings.SIMULATOR_HOST,
    )


def gateway_address(text: str) -> Address:
    """Return the address to connect to; a gateway on all interfaces is reached on this host. Raises InvalidStationAddress."""
    host, port = address_of(text)
    return {"0.0.0.0": "127.0.0.1", "::": "::1"}.get(host, host), port  # noqa: S104 - compared, not bound
