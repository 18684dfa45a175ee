"""Another plan for the rest of a flying mission: computed, offered, and flown once a user confirms it."""

from missions.services.replanning.accepting import accept_offer
from missions.services.replanning.offers import REPLAN, ask_for_offer, decline_offer, settle_offers, suggest, withdraw
from missions.services.replanning.working_out import work_out_for_job
from missions.services.replanning.zones_ahead import suggest_for_zones

__all__ = [
    "REPLAN",
    "accept_offer",
    "ask_for_offer",
    "decline_offer",
    "settle_offers",
    "suggest",
    "suggest_for_zones",
    "withdraw",
    "work_out_for_job",
]
