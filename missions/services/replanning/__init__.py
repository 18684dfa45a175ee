"""Another way to do what is left of a mission that flies: worked out, offered, and flown once somebody confirms it."""

from missions.services.replanning.accepting import accept_offer
from missions.services.replanning.offers import ask_for_offer, decline_offer, settle_offers, suggest
from missions.services.replanning.working_out import work_out_for_job

__all__ = ["accept_offer", "ask_for_offer", "decline_offer", "settle_offers", "suggest", "work_out_for_job"]
