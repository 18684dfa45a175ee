"""An offer worked out: the best of several ways that may be flown, stored as a mission beside what it would change."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from django.db import transaction
from django.utils import timezone
from django.utils.translation import gettext as _

from missions.models import MissionState, OfferState, ReplanOffer
from missions.selectors.missions import mission_of_organisation
from missions.services.commands.refused import RefusalReason
from missions.services.replanning.difference import difference_of
from missions.services.replanning.offers import end_offer, held_offer
from missions.services.replanning.proposals import Field, Proposal, field_of, proposals
from missions.services.replanning.rest import Cause, rests_of
from missions.services.replanning.staleness import basis_of, valid_until
from missions.services.replanning.storing import stored
from planning.solver.solver import Stop
from workspace.jobs.services import JobCancelled, finish_job
from workspace.live.changes import publish_live
from workspace.models import Job


def work_out_for_job(*, job: Job, stop: Stop, search_s: float, note: Callable[[float, str], None]) -> None:
    """The offer of the job becomes open, or impossible with the reasons; together with the job's end. Safe to run twice."""
    offer = ReplanOffer.objects.select_related("mission__organisation").get(pk=job.parameters["offer"])
    if offer.state == OfferState.COMPUTING:
        _work_out(offer, stop, search_s, note)
    offer.refresh_from_db()
    if not finish_job(job=job, result={"offer": str(offer.pk), "state": offer.state}, message=offer.outcome or "Worked out"):
        raise JobCancelled


def _work_out(offer: ReplanOffer, stop: Stop, search_s: float, note: Callable[[float, str], None]) -> None:
    now = timezone.now()
    mission = mission_of_organisation(offer.mission.organisation, offer.mission_id)
    cause = Cause(offer.code, offer.cause.get("uav"), offer.cause.get("zone"))
    if mission.state != MissionState.ACTIVE:
        return _close(offer, OfferState.OUTDATED, _("The mission does not fly any more."))
    note(0.1, "Looking up what is left")
    field = replace(field_of(mission, rests_of(mission, cause, now), cause, now), stop=stop, search_s=search_s)
    words = _open_the_best(offer, field, note)
    if words:
        _close(offer, OfferState.IMPOSSIBLE, words)
    return None


def _open_the_best(offer: ReplanOffer, field: Field, note: Callable[[float, str], None]) -> str:
    """Why there is none; empty where there is one. The first that leaves nothing undone is taken, else the best of all."""
    found: list[Proposal] = []
    words: list[str] = []
    for number, proposal in enumerate(proposals(field)):
        note(min(0.9, 0.3 + 0.15 * number), "Comparing ways to share it out")
        if not proposal.continued:
            words += [message for _code, message, _why in proposal.unreached.values()]
            continue
        if not proposal.unreached and not (reasons := _open(offer, proposal)):
            return ""
        if not proposal.unreached:
            words += [reason.message for reason in reasons]
        else:
            found.append(proposal)
    for proposal in sorted(found, key=lambda one: one.merit):
        reasons = _open(offer, proposal)
        if not reasons:
            return ""
        words += [reason.message for reason in reasons]
    troubles = [field.why(rest.place) for rest in field.rests]
    reported = dict.fromkeys(filter(None, [*words, *troubles]))
    return "\n".join(reported) or _("Nothing would change: the UAVs fly on as they do.")


def _open(offer: ReplanOffer, proposal: Proposal) -> list[RefusalReason]:
    """What speaks against it; none where it is open now."""
    now = timezone.now()
    with transaction.atomic():
        held = held_offer(offer)
        if held.state != OfferState.COMPUTING:
            return []
        continuation, reasons = stored(proposal, now=now)
        if continuation is None:
            return reasons
        uavs = [rest.uav.pk for rest in proposal.field.rests if rest.uav is not None]
        held.difference = difference_of(proposal, now=now, valid_until=valid_until(continuation, now)) | {"basis": basis_of(uavs)}
        held.continuation, held.state = continuation, OfferState.OPEN
        held.save(update_fields=["difference", "continuation", "state"])
        transaction.on_commit(partial(publish_live, held.mission.organisation_id))
    return []


def _close(offer: ReplanOffer, state: OfferState, words: str) -> None:
    with transaction.atomic():
        held = held_offer(offer)
        if held.state == OfferState.COMPUTING:
            end_offer(held, state, words)
