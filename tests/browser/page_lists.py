"""The addresses of the pages, by who may open them: what looks at every page looks at these."""

FOR_STRANGERS = ("/sign-in", "/lost-password", "/lost-password/sent", "/api/docs")
FOR_OPERATORS = (
    "/",
    "/missions/new",
    "/uavs",
    "/live",
    "/assets",
    "/assets/data-issues",
    "/terrain",
    "/findings",
    "/zones",
    "/review",
    "/account",
    "/change-password",
    "/no-such-page",
)
FOR_CURATORS = ("/imports",)
FOR_ADMINISTRATORS = ("/administration",)
