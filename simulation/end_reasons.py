"""Why simulations and simulated UAVs have ended, by the codes that are stored, in the reader's language."""

from django.utils.translation import gettext_lazy

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
