"""Compute an offer: the best permitted proposal, stored as a mission with the difference to the flying one."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from django.db import transaction
from django.utils import timezone

from missions.models import MissionState, OfferState, ReplanOffer
from missions.selectors.missions import mission_of_organisation
from missions.services.commands.refused import RefusalReason
from missions.services.replanning.difference import difference_of
from missions.services.replanning.offers import end_offer, held_offer
from missions.services.replanning.proposals import Field, Proposal, field_of, proposals
from missions.services.replanning.rest import OfferCause, rests_of
from missions.services.replanning.staleness import basis_of, valid_until
from missions.services.replanning.storing import stored
from operation.reasons import Reason, Why, reason_from_json, text_reason
from planning.solver.solver import Stop
from workspace.jobs.services import JobCancelled, finish_job
from workspace.live.changes import publish_live
from workspace.models import Job
from workspace.reason_texts import why_of_column


def work_out_for_job(*, job: Job, stop: Stop, search_s: float, note: Callable[[float, Why], None]) -> None:
    """Open the job's offer, or end it as impossible with the reasons, together with the job's end. Safe to run twice."""
    offer = ReplanOffer.objects.select_related("mission__organisation").get(pk=job.parameters["offer"])
    if offer.state == OfferState.COMPUTING:
        _work_out(offer, stop, search_s, note)
    offer.refresh_from_db()
    message = why_of_column(offer.outcome_why, offer.outcome) or Reason("worked_out")
    if not finish_job(job=job, result={"offer": str(offer.pk), "state": offer.state}, message=message):
        raise JobCancelled


def _work_out(offer: ReplanOffer, stop: Stop, search_s: float, note: Callable[[float, Why], None]) -> None:
    now = timezone.now()
    mission = mission_of_organisation(offer.mission.organisation, offer.mission_id)
    cause = OfferCause(offer.code, offer.cause.get("uav"), offer.cause.get("zone"))
    if mission.state != MissionState.ACTIVE:
        return _close(offer, OfferState.OUTDATED, [Reason("mission_not_flying")])
    note(0.1, Reason("looking_up_rest"))
    field = replace(field_of(mission, rests_of(mission, cause, now), cause, now), stop=stop, search_s=search_s)
    why = _open_the_best(offer, field, note)
    if why:
        _close(offer, OfferState.IMPOSSIBLE, why)
    return None


def _open_the_best(offer: ReplanOffer, field: Field, note: Callable[[float, Why], None]) -> list[Reason]:
    """Open the first proposal without unreached targets, else the best of all; returns why there is none, empty where there is one."""
    found: list[Proposal] = []
    why: list[Reason] = []
    for number, proposal in enumerate(proposals(field)):
        note(min(0.9, 0.3 + 0.15 * number), Reason("comparing_shares"))
        if not proposal.continued:
            why += [reason for _code, message, json in proposal.unreached.values() for reason in _reasons(message, json)]
            continue
        if not proposal.unreached and not (reasons := _open(offer, proposal)):
            return []
        if not proposal.unreached:
            why += [text_reason(reason.message) for reason in reasons]
        else:
            found.append(proposal)
    for proposal in sorted(found, key=lambda one: one.merit):
        reasons = _open(offer, proposal)
        if not reasons:
            return []
        why += [text_reason(reason.message) for reason in reasons]
    why += [reason for rest in field.rests for reason in field.why(rest.place)]
    return list({str(reason): reason for reason in why}.values()) or [Reason("nothing_would_change")]


def _reasons(message: str, why: Sequence[Mapping[str, Any]]) -> list[Reason]:
    return [reason_from_json(reason) for reason in why] or [text_reason(message)]


def _open(offer: ReplanOffer, proposal: Proposal) -> list[RefusalReason]:
    """Return the reasons against a proposal; empty where it is open now."""
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


def _close(offer: ReplanOffer, state: OfferState, why: Sequence[Reason]) -> None:
    with transaction.atomic():
        held = held_offer(offer)
        if held.state == OfferState.COMPUTING:
            end_offer(held, state, why)
