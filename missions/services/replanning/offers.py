"""Offers of another plan for a flying mission: requested, suggested, declined, outdated. None of them changes what is flown."""

from datetime import datetime, timedelta
from functools import partial
from typing import Any
from uuid import UUID

from django.db import transaction
from django.utils import timezone
from django.utils.translation import gettext as _

from missions.models import Mission, MissionState, OfferState, ReplanOffer, Uav
from missions.services.commands.refused import refuse
from missions.services.missions import note
from missions.services.replanning.staleness import why_outdated
from operation.reasons import Reason, Why
from workspace.jobs.services import create_job
from workspace.live.changes import publish_live
from workspace.models import Job, User
from workspace.reason_texts import text_and_column

REPLAN = "missions.tasks.replan_mission"
ASKED_FOR = "asked-for"
UNDECIDED = (OfferState.COMPUTING, OfferState.OPEN)
WORKED_OUT_WITHIN = timedelta(seconds=120)  # afterwards the worker counts as lost
MAX_OFFERS_OF_CAUSE = 40  # of one flight: until a user decides, each outdated offer is followed by another


def ask_for_offer(*, mission: Mission, actor: User) -> tuple[ReplanOffer, Job]:
    """Start computing an offer for a user and set an open one aside. Raises Refused."""
    with transaction.atomic():
        held = Mission.objects.select_for_update(no_key=True).get(pk=mission.pk)
        if held.state != MissionState.ACTIVE:
            raise refuse("not_flying", _("Only what is left of a mission that flies can be planned again."))
        _set_aside(held, Reason("asked_for_again"))
        return _begin(held, ASKED_FOR, {"code": ASKED_FOR}, actor)


def suggest(*, mission_id: UUID, code: str, cause: dict[str, Any]) -> ReplanOffer | None:
    """Start an offer once per cause: `code` uav-out, zone-active or battery-short with `uav` (its key) or `zone`, and further values.

    Returns None where the mission does not fly, or an offer for this cause exists and is not outdated. The schedule
    (tasks.look_after_offers) sends its job to the planners within seconds.
    """
    with transaction.atomic():
        held = Mission.objects.select_for_update(no_key=True).filter(pk=mission_id, state=MissionState.ACTIVE, deleted_at=None).first()
        if held is None:
            return None
        named = {"code": code, **{name: cause[name] for name in ("uav", "zone") if cause.get(name) is not None}}
        of_cause = held.replan_offers.filter(code=code, cause__contains=named)
        if of_cause.exclude(state=OfferState.OUTDATED).exists() or of_cause.count() >= MAX_OFFERS_OF_CAUSE:
            return None
        _set_aside(held, Reason("something_else_happened"))
        offer, _job = _begin(held, code, {**cause, **named}, None)
    return offer


def withdraw(*, mission_id: UUID, code: str, uav_id: int) -> bool:
    """End the undecided offer for a UAV that was out or short of battery and has recovered; returns whether there was one.

    The offer becomes outdated and is not computed again. If the cause comes back, it makes another offer.
    """
    with transaction.atomic():
        held = Mission.objects.select_for_update(no_key=True).filter(pk=mission_id).first()
        if held is None:
            return False
        undecided = held.replan_offers.select_for_update(of=("self",)).select_related("mission")
        offer = undecided.filter(state__in=UNDECIDED, code=code, cause__uav=uav_id).first()
        if offer is None:
            return False
        name = Uav.objects.values_list("name", flat=True).get(pk=uav_id)
        end_offer(offer, OfferState.OUTDATED, Reason("reason_has_ended", {"uav": name}))
    return True


def decline_offer(*, offer: ReplanOffer, actor: User) -> ReplanOffer:
    """Decline an offer; the mission continues unchanged. A repeated call changes nothing. Raises Refused."""
    with transaction.atomic():
        held = held_offer(offer)
        if held.state == OfferState.DECLINED:
            return held
        if held.state not in UNDECIDED:
            raise refuse("decided", _("This offer is no longer open."))
        end_offer(held, OfferState.DECLINED, actor=actor)
    return held


def settle_offers(*, now: datetime | None = None) -> int:
    """Mark offers outdated that the mission has passed or that no worker computes any more; returns how many.

    While the mission flies, each is computed again for the same cause.
    """
    moment = now or timezone.now()
    found = 0
    for key in list(ReplanOffer.objects.filter(state__in=UNDECIDED).values_list("pk", flat=True)):
        with transaction.atomic():
            offer = ReplanOffer.objects.select_related("mission").get(pk=key)
            held = held_offer(offer)
            if held.state == OfferState.OPEN:
                why = why_outdated(held, moment)
            elif held.state == OfferState.COMPUTING and held.created_at + WORKED_OUT_WITHIN < moment:
                why = Reason("not_worked_out_in_time")
            else:
                continue
            if why is not None:
                end_offer(held, OfferState.OUTDATED, why)
                _compute_again(held)
                found += 1
    return found


def _compute_again(offer: ReplanOffer) -> None:
    """Compute an outdated offer again. The caller holds the rows."""
    mission = offer.mission
    if mission.state != MissionState.ACTIVE or mission.deleted_at is not None:
        return
    if mission.replan_offers.filter(code=offer.code, cause=offer.cause).count() < MAX_OFFERS_OF_CAUSE:
        _begin(mission, offer.code, offer.cause, None)


def held_offer(offer: ReplanOffer) -> ReplanOffer:
    """Return the row, locked until the caller's transaction ends; the mission's row is locked before it, as everywhere."""
    Mission.objects.select_for_update(no_key=True).values_list("pk").get(pk=offer.mission_id)
    return ReplanOffer.objects.select_for_update(of=("self",)).select_related("mission", "continuation").get(pk=offer.pk)


def end_offer(offer: ReplanOffer, state: OfferState, why: Why = (), *, actor: User | None = None) -> None:
    """End an offer; the caller holds the rows. The offered mission is deleted unless it is accepted."""
    offer.state = state
    offer.outcome, offer.outcome_why = text_and_column(why, 500, "\n")
    if actor is not None:
        offer.decided_by, offer.decided_at = actor, timezone.now()
    offer.save(update_fields=["state", "outcome", "outcome_why", "decided_by", "decided_at"])
    if state != OfferState.ACCEPTED and offer.continuation_id is not None:
        Mission.objects.filter(pk=offer.continuation_id, state=MissionState.PLANNED).update(deleted_at=timezone.now())
    transaction.on_commit(partial(publish_live, offer.mission.organisation_id))
    note(offer.mission, actor, f"replan-{state}", before=None, after={"offer": str(offer.pk), "code": offer.code, "why": offer.outcome})


def _set_aside(mission: Mission, why: Reason) -> None:
    for offer in mission.replan_offers.select_for_update(of=("self",)).select_related("mission").filter(state__in=UNDECIDED):
        end_offer(offer, OfferState.OUTDATED, why)


def _begin(mission: Mission, code: str, cause: dict[str, Any], actor: User | None) -> tuple[ReplanOffer, Job]:
    offer = ReplanOffer.objects.create(mission=mission, code=code, cause=cause)
    about = {"offer": str(offer.pk)}
    job = create_job(organisation=mission.organisation, created_by=actor, task=REPLAN, parameters=about, message=Reason("working_out_rest"))
    transaction.on_commit(partial(publish_live, mission.organisation_id))
    note(mission, actor, "replan", before=None, after={"offer": str(offer.pk), "code": code, "cause": cause})
    return offer, job
