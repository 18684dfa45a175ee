"""How targets fare in the air: their states follow what UAVs report of them."""

from missions.models import InspectionTarget, TargetState


def move_target(*, target_id: int, state: TargetState) -> bool:
    """Set it. False where there is no such target any more; what it was before does not matter."""
    return bool(InspectionTarget.objects.filter(pk=target_id).update(state=state))
