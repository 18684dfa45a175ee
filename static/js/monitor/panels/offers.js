/** A card on top of the alerts for each offer of another plan: what would change, drawn dashed on the map, one confirmation. */

import { ApiError, get, post } from "../../api.js";
import { byId, h, icon, setChildren } from "../../dom.js";
import { colourClass, routeNumber } from "../../domain/palette.js";
import { askToClose } from "../../page/close_mission.js";
import { confirmAct } from "../../page/confirm.js";
import { announce, toast } from "../../page/toast.js";
import { t } from "../../text.js";
import {
  causeWords,
  differenceOf,
  drawnOffer,
  isUndecided,
  overWords,
  sentenceOf,
  targetLines,
  uavLines,
  validWords,
  whyNotDecided,
} from "../text/offer_text.js";

/** @import { Answer } from "../../api.js" */
/** @import { Mission } from "../../api_types.d.ts" */
/** @import { LiveOffer, MonitorPage, MonitorState, MonitorStore, OfferedRoute } from "../types.d.ts" */

/** Offers whose decision is being sent: prevents a second decision. @type {Set<string>} */
const deciding = new Set();

/** @param {LiveOffer} offer @param {"accept" | "decline"} act @param {string} words once it is done */
async function decide(offer, act, words) {
  if (deciding.has(offer.id)) return;
  deciding.add(offer.id);
  try {
    await post(`/replan-offers/${offer.id}/${act}`, {}, { headers: { "If-Match": `"${offer.revision}"` } });
    announce(words);
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    deciding.delete(offer.id);
    toast(error.message);
  }
}

/**
 * Accept an offer after confirmation. The UAVs fly on while the question is open: an offer that has expired meanwhile is not sent.
 * @param {MonitorStore} store @param {LiveOffer} offer @param {HTMLElement} opener
 */
async function accept(store, offer, opener) {
  const { uavs = [] } = differenceOf(offer);
  const held = uavs.flatMap(({ change, name }) => (change === "changed" ? name : [])).join(", ");
  const asked = await confirmAct({
    title: t("Accept the re-plan?"),
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
      t("The current mission ends; its open targets continue as a new mission."),
    ],
    keep: t("Keep current plan"),
    act: t("Accept re-plan"),
  });
  if (!asked) return;
  const current = store.state.offers.find(({ id }) => id === offer.id);
  const whyNot = current?.state === "open" ? whyNotDecided(current, store.state) : overWords(current ?? offer).rest;
  if (current?.state === "open" && !whyNot) await decide(current, "accept", t("Re-plan accepted."));
  else toast([whyNot, t("Nothing was sent. Check the re-plan offered now.")].filter(Boolean).join(" "));
}

/** @param {LiveOffer} offer */
const computingCard = (offer) =>
  h(
    "article",
    { class: "offer" },
    h("h3", {}, icon("loader-circle"), t("Computing a re-plan")),
    h("p", { class: "caption" }, causeWords(offer)),
  );

/** Colours of the mission in flight. @param {Pick<MonitorState, "missions">} state @param {LiveOffer} offer */
const coloursOf = ({ missions }, { mission }) => missions.find(({ id }) => id === mission)?.colours;

/** What each UAV would fly. @param {LiveOffer} offer @param {readonly number[]} [colours] of its mission */
const uavList = (offer, colours) =>
  h(
    "ul",
    { class: "offer-uavs" },
    uavLines(offer).map(({ place, letter, name, what, before, after, why }) => {
      const figures = (before || after) && h("small", {}, before ? `${before} → ${after}` : after);
      const summary = h("span", {}, h("strong", {}, name), ` ${what}`, figures, why && h("small", {}, why));
      return h(
        "li",
        { class: colourClass(routeNumber(place, colours)) },
        h("span", { class: "letter" }, letter),
        summary,
      );
    }),
  );

/** Targets that change hands, folded. @param {LiveOffer} offer */
function targetList(offer) {
  const lines = targetLines(offer).map((line) => h("li", {}, line));
  return lines.length > 0 && h("details", {}, h("summary", {}, t("Targets")), h("ul", {}, lines));
}

/** @param {MonitorStore} store @param {LiveOffer} offer @param {string} whyNot */
function buttons(store, offer, whyNot) {
  /** @param {Event} event */
  const onAccept = ({ currentTarget }) => void accept(store, offer, /** @type {HTMLElement} */ (currentTarget));
  const onDecline = () => void decide(offer, "decline", t("Declined: the approved plan continues."));
  const isDeciding = deciding.has(offer.id);
  const how = { type: "button", disabled: isDeciding || whyNot !== "", title: whyNot || null };
  return h(
    "div",
    { class: "alert-acts" },
    h("button", { ...how, class: "button primary", onclick: onAccept }, t("Accept")),
    h("button", { ...how, class: "button", onclick: onDecline }, t("Decline")),
  );
}

/** @param {MonitorStore} store @param {LiveOffer} offer @param {boolean} canFly @param {string} whyNot */
function card(store, offer, canFly, whyNot) {
  if (offer.state === "computing") return computingCard(offer);
  const { valid_until } = differenceOf(offer);
  const until = h("p", { class: "caption countdown", "data-until": valid_until });
  return h(
    "article",
    { class: "offer" },
    h("h3", {}, icon("waypoints"), t("Re-plan offered")),
    h("p", {}, h("strong", {}, `${causeWords(offer)}.`), ` ${sentenceOf(offer)}.`),
    uavList(offer, coloursOf(store.state, offer)),
    targetList(offer),
    whyNot ? h("p", { class: "caption" }, whyNot) : valid_until && until,
    canFly && buttons(store, offer, whyNot),
  );
}

/** The time left, without a new card each second: a button keeps its focus. @param {number} now_ms */
function count(now_ms) {
  for (const line of /** @type {NodeListOf<HTMLElement>} */ (byId("offer-list").querySelectorAll(".countdown")))
    line.textContent = validWords(line.dataset.until ?? "", now_ms);
}

/**
 * The outcome of an offer, and where the flight continues.
 *
 * @param {LiveOffer} offer
 * @param {{ goesOn: string | null, open: string[], canFly: boolean, onPutAway: () => void }} more `goesOn` is an address, `open` are
 *   targets that no plan reaches
 */
function overCard(offer, { goesOn, open, canFly, onPutAway }) {
  const { strong, rest } = overWords(offer, open);
  const isLeft = offer.state === "impossible" && open.length > 0 && canFly;
  const words = t("Dismiss");
  const image = icon(offer.state === "accepted" ? "circle-check" : "info", "small");
  const put = { type: "button", class: "icon-button tight", "aria-label": words, title: words, onclick: onPutAway };
  return h(
    "article",
    { class: "offer over" },
    h("p", {}, image, h("span", {}, h("strong", {}, strong), rest && ` ${rest}`)),
    h("button", put, icon("x", "small")),
    goesOn && h("a", { class: "button primary", href: goesOn }, t("Follow the new mission")),
    isLeft && h("button", { type: "button", class: "button", onclick: followUp(offer.mission) }, t("Plan a follow-up")),
  );
}

/** Closes the mission, which asks for reasons and offers the follow-up. @param {string} mission */
const followUp =
  (mission) =>
  (/** @type {Event} */ { currentTarget }) =>
    askToClose({ mission, opener: /** @type {HTMLElement} */ (currentTarget) });

/** Labels of the open targets. @param {MonitorState["missions"]} missions @param {string} id of one of them */
const openTargets = (missions, id) =>
  (missions.find((mission) => mission.id === id)?.targets ?? [])
    .filter(({ state }) => state === "pending" || state === "in-progress")
    .map(({ label }) => label);

/**
 * Routes of the offered plan, by the UAVs that would fly them; none where it cannot be read.
 * @param {LiveOffer} offer @param {readonly number[]} [colours] @returns {Promise<OfferedRoute[]>}
 */
async function readRoutes(offer, colours) {
  try {
    const { data } = /** @type {Answer<Mission>} */ (await get(`/missions/${offer.continuation}`));
    return (differenceOf(offer).uavs ?? []).flatMap(({ place, continuation_place }) => {
      const geometry = data.plan?.routes[continuation_place ?? -1]?.geometry;
      return geometry ? { colour: routeNumber(place, colours), geometry } : [];
    });
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    return [];
  }
}

/** @param {MonitorStore} store @param {MonitorPage} page */
export function mountOffers(store, page) {
  let drawn = "";
  let routesOf = ""; // the mission whose routes are on the map
  /** @type {Set<string>} */
  const putAway = new Set();

  /** The offered routes, in the colours of the UAVs that would fly them. @param {LiveOffer | undefined} offer */
  async function drawRoutes(offer) {
    const wanted = offer?.continuation ?? "";
    if (wanted === routesOf) return;
    routesOf = wanted;
    const offered = offer && wanted ? await readRoutes(offer, coloursOf(store.state, offer)) : [];
    if (routesOf === wanted) store.update({ offered });
  }

  /** Show the newest closed offer until the user dismisses it. @param {LiveOffer} offer @param {string[]} open */
  function over(offer, open) {
    const isFollowed = offer.state === "accepted" && page.mission === offer.mission;
    return overCard(offer, {
      goesOn: isFollowed ? `/missions/${offer.continuation}/fly` : null,
      open,
      canFly: page.canFly,
      onPutAway() {
        putAway.add(offer.id);
        draw(store.state);
      },
    });
  }

  /** @param {Readonly<MonitorState>} state */
  function draw(state) {
    const { offers } = state;
    const undecided = offers.filter(isUndecided);
    const [newest] = offers
      .filter((offer) => !isUndecided(offer))
      .sort((a, b) => Date.parse(b.created_at) - Date.parse(a.created_at));
    const last = undecided.length === 0 && newest && !putAway.has(newest.id) ? newest : null;
    const whyNot = new Map(undecided.map((offer) => [offer.id, whyNotDecided(offer, state)]));
    const open = last?.state === "impossible" ? openTargets(state.missions, last.mission) : [];
    const key = JSON.stringify([undecided, last, open, [...whyNot], [...deciding]]);
    if (key === drawn) return count(state.now_ms);
    drawn = key;
    byId("offers").hidden = undecided.length === 0 && last === null;
    setChildren(
      byId("offer-list"),
      last ? over(last, open) : undecided.map((offer) => card(store, offer, page.canFly, whyNot.get(offer.id) ?? "")),
    );
    count(state.now_ms);
    void drawRoutes(drawnOffer(offers, state));
  }

  store.listen(["offers", "missions", "now_ms", "silent_ms"], draw);
}
