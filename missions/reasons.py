"""The sentence of each code that tells what became of commands, offers and plans."""

from operation.reasons import gettext_noop, register_sentences

SENTENCES = register_sentences({
    # what the outbox ends commands with
    "superseded": gettext_noop("A later command took its place."),
    "not_delivered": gettext_noop("It could not be delivered in time."),
    "not_sent_in_time": gettext_noop("It was not sent in time."),
    "unconfirmed": gettext_noop("It was sent; whether it was done is not known."),
    "unacknowledged": gettext_noop(
        "Sent again and again; nothing is heard from the UAV, and whether it does it is not known."
    ),
    "withdrawn": gettext_noop("It was withdrawn before it was sent."),
    "revoked": gettext_noop("The approval was revoked."),
    "simulation_ended": gettext_noop("The simulation has ended."),
})  # fmt: skip
