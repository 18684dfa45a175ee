/** A card on top of the alerts for each offer of another plan: what would change, drawn dashed on the map, one confirmation. */

import { ApiError, get, post } from "../../api.js";
import { byId, h, icon } from "../../dom.js";
import { routeNumber } from "../../domain/palette.js";
import { confirmAct } from "../../page/confirm.js";
import { say, toast } from "../../page/toast.js";
import { t } from "../../text.js";
import { clockText } from "../../units.js";
import { causeWords, isUndecided, overWords, sentenceOf, targetLines, uavLines } from "../offer_words.js";

export function mountOffers(store, page) {
  let drawn = "";
  const putAway = new Set();
  let routesOf = ""; // the offer whose routes are on the map

  async function decide(offer, act, words) {
    try {
      await post(`/replan-offers/${offer.id}/${act}`, {});
      say(words);
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      toast(error.message);
    }
  }

  async function accept(offer, opener) {
    const held = offer.difference.uavs
      .filter(({ change }) => change === "changed")
      .map(({ name }) => name)
      .join(", ");
    const asked = await confirmAct({
      title: t("Fly the other plan?"),
      image: "waypoints",
      opener,
      lines: [
        `${sentenceOf(offer)}.`,
        held &&
          t(
            "{names}: held, given the new route while they hover, and started again. Where a step fails a UAV stays held.",
            { names: held },
          ),
        ...targetLines(offer).slice(0, 6),
        t("What is approved now ends; the rest goes on as a mission of its own."),
      ],
      keep: t("Keep the plan"),
      act: t("Fly the other plan"),
    });
    if (asked) await decide(offer, "accept", t("The other plan is flown."));
  }

  function card(offer) {
    if (offer.state === "computing")
      return h(
        "article",
        { class: "offer" },
        h("h3", {}, icon("loader-circle"), t("Another plan is being worked out")),
        h("p", { class: "caption" }, causeWords(offer)),
      );
    const { valid_until } = offer.difference;
    return h(
      "article",
      { class: "offer" },
      h("h3", {}, icon("waypoints"), t("Another plan is offered")),
      h("p", {}, h("strong", {}, `${causeWords(offer)}.`), ` ${sentenceOf(offer)}.`),
      h(
        "ul",
        { class: "offer-uavs" },
        uavLines(offer).map(({ place, letter, name, what, before, after, why }) =>
          h(
            "li",
            { class: `route-${routeNumber(place)}` },
            h("span", { class: "letter" }, letter),
            h(
              "span",
              {},
              h("strong", {}, name),
              ` ${what}`,
              (before || after) && h("small", {}, before ? `${before} → ${after}` : after),
              why && h("small", {}, why),
            ),
          ),
        ),
      ),
      targetLines(offer).length > 0 &&
        h(
          "details",
          {},
          h("summary", {}, t("Targets")),
          h(
            "ul",
            {},
            targetLines(offer).map((line) => h("li", {}, line)),
          ),
        ),
      valid_until &&
        h("p", { class: "caption" }, t("Holds until {time}. Dashed on the map.", { time: clockText(valid_until) })),
      page.canFly &&
        h(
          "div",
          { class: "alert-acts" },
          h(
            "button",
            { type: "button", class: "button primary", onclick: (event) => void accept(offer, event.currentTarget) },
            t("Accept"),
          ),
          h(
            "button",
            {
              type: "button",
              class: "button",
              onclick: () => void decide(offer, "decline", t("Declined: the plan stays as it is.")),
            },
            t("Decline"),
          ),
        ),
    );
  }

  /** The newest that is over, until somebody puts it away: what became of it, and where the flight goes on. */
  function over(offer) {
    const { strong, rest } = overWords(offer);
    const goesOn = offer.state === "accepted" && page.mission === offer.mission;
    return h(
      "article",
      { class: "offer over" },
      h(
        "p",
        {},
        icon(offer.state === "accepted" ? "circle-check" : "info", "small"),
        h("span", {}, h("strong", {}, strong), rest && ` ${rest}`),
      ),
      h(
        "button",
        {
          type: "button",
          class: "icon-button tight",
          "aria-label": t("Put away"),
          title: t("Put away"),
          onclick: () => (putAway.add(offer.id), draw(store.state)),
        },
        icon("x", "small"),
      ),
      goesOn && h("a", { class: "button primary", href: `/missions/${offer.continuation}/fly` }, t("Watch it go on")),
    );
  }

  /** The offered routes, in the colours of the UAVs that would fly them. */
  async function drawRoutes(offer) {
    const wanted = offer?.continuation ?? "";
    if (wanted === routesOf) return;
    routesOf = wanted;
    let offered = [];
    if (wanted) {
      try {
        const { routes } = (await get(`/missions/${wanted}`)).data.plan;
        offered = offer.difference.uavs
          .filter(({ continuation_place }) => continuation_place !== null)
          .map(({ place, continuation_place }) => ({ place, geometry: routes[continuation_place]?.geometry }))
          .filter(({ geometry }) => geometry);
      } catch (error) {
        if (!(error instanceof ApiError)) throw error;
      }
    }
    if (routesOf === wanted) store.update({ offered });
  }

  function draw({ offers }) {
    const undecided = offers.filter(isUndecided);
    const [newest] = offers
      .filter((offer) => !isUndecided(offer))
      .sort((a, b) => Date.parse(b.created_at) - Date.parse(a.created_at));
    const last = undecided.length === 0 && newest && !putAway.has(newest.id) ? newest : null;
    const key = JSON.stringify([undecided, last]);
    if (key === drawn) return;
    drawn = key;
    byId("offers").hidden = undecided.length === 0 && last === null;
    byId("offer-list").replaceChildren(...(last ? [over(last)] : undecided.map(card)));
    void drawRoutes(undecided.find(({ state }) => state === "open"));
  }

  store.listen(["offers"], draw);
}
