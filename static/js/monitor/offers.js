/** Offers of another plan for what is left: what would change, in a sentence a UAV, and one decision. */

import { post } from "../api.js";
import { byId, h, icon, keyedList } from "../dom.js";
import { routeLetter } from "../map/palette.js";
import { confirmAct } from "../mission/panels/confirm.js";
import { toast } from "../page/toast.js";
import { t, tn } from "../text.js";
import { clockText } from "../units.js";

const TITLES = {
  "uav-out": t("A UAV has dropped out: another plan for what is left"),
  "zone-active": t("A zone is in the way: another plan for what is left"),
  "battery-short": t("A battery will not do: another plan for what is left"),
  "asked-for": t("Another plan for what is left"),
};

const letters = (targets, labels) => targets.map((place) => labels.get(place)?.label ?? `${place + 1}`).join(", ");

/** One sentence of what changes for a UAV. */
export function changeWords({ name, change, gained, lost, after }, labels) {
  if (change === "out") return t("{name} is out.", { name });
  if (change === "recalled") return t("{name} is told to return.", { name });
  if (change === "untouched") return t("{name} flies on as approved.", { name });
  const parts = [gained.length && t("takes {targets}", { targets: letters(gained, labels) }), lost.length && t("leaves {targets}", { targets: letters(lost, labels) })].filter(Boolean);
  const ends = after?.ends_at ? t("ends {time}", { time: clockText(after.ends_at) }) : "";
  const battery = after && after.battery_percent !== null ? t("with {percent} % left", { percent: Math.round(after.battery_percent) }) : "";
  return `${name}: ${[parts.join(", ") || t("flies another way"), [ends, battery].filter(Boolean).join(" ")].filter(Boolean).join("; ")}.`;
}

export function mountOffers({ canAct, labelsFor, timeText }) {
  async function decide(offer, act, question) {
    const asked = await confirmAct(question);
    if (!asked) return;
    try {
      await post(`/replan-offers/${offer.id}/${act}`, {}, { headers: { "Idempotency-Key": crypto.randomUUID?.() ?? `${Date.now()}-${Math.random()}` } });
    } catch (error) {
      toast(error.message);
    }
  }

  function lines(offer, labels) {
    const { uavs = [], targets = [], unreached = 0 } = offer.difference ?? {};
    return [...uavs.map((uav) => [`${routeLetter(uav.place)} · `, changeWords(uav, labels), uav.why && ` ${uav.why}`]), ...targets.filter(({ to }) => to === null).map(({ label, message }) => [t("{label} stays undone.", { label }), message && ` ${message}`]), unreached === 0 && uavs.length ? [t("No target is given up.")] : null].filter(Boolean);
  }

  function refresh(card, offer) {
    const said = JSON.stringify(offer);
    if (card.dataset.said === said) return;
    card.dataset.said = said;
    const labels = labelsFor(offer.mission);
    const isOpen = offer.state === "open";
    const words = { computing: t("Being worked out."), accepted: t("Accepted: the UAVs are being told."), declined: t("Declined."), outdated: offer.outcome || t("It no longer fits what flies."), impossible: offer.outcome || t("No other way was found.") }[offer.state];
    card.className = `offer-card ${offer.state}`;
    card.replaceChildren(
      h("div", { class: "alert-head" }, icon("waypoints"), h("strong", {}, TITLES[offer.code] ?? TITLES["asked-for"]), h("time", { datetime: offer.created_at }, timeText(offer.created_at))),
      words && h("p", { class: "caption" }, words),
      isOpen && h("ul", { class: "offer-lines" }, lines(offer, labels).map((line) => h("li", {}, line))),
      isOpen && canAct && h("div", { class: "alert-acts" },
        h("button", { type: "button", class: "button small primary", onclick: () => void decide(offer, "accept", { title: t("Fly it this way instead?"), lines: [...lines(offer, labels).map((line) => line.filter(Boolean).join("")), t("Each UAV that changes its route is held, gets the new one, which is read back, and goes on. Nothing else changes.")], act: t("Accept"), keep: t("Not yet"), isBack: true, image: "waypoints" }) }, t("Accept")),
        h("button", { type: "button", class: "button small", onclick: () => void decide(offer, "decline", { title: t("Decline the offer?"), lines: [t("The mission goes on as it was approved. Another offer can be asked for at any time.")], act: t("Decline"), keep: t("Not yet"), isBack: true }) }, t("Decline"))),
    );
  }

  const draw = keyedList(byId("live-offers"), ({ id }) => id, () => h("li", { class: "offer-card" }), refresh);
  return (offers) => draw([...offers].sort((a, b) => Date.parse(b.created_at) - Date.parse(a.created_at)).slice(0, 3));
}

/** For screen readers: how many wait for a decision. */
export const offersWords = (offers) => {
  const open = offers.filter(({ state }) => state === "open").length;
  return open ? tn(open, "{count} offer of another plan waits for a decision.", "{count} offers of another plan wait for a decision.") : "";
};
