/** The list of UAVs: who it is, how it does, how sure that is, and where on its route it is. */

import { byId, h, icon, keyedList } from "../dom.js";
import { routeLetter, routeNumber } from "../map/palette.js";
import { profileOf } from "../mission/span_strip.js";
import { t } from "../text.js";
import { clockText, heightText, lengthText, percentText, speedText } from "../units.js";
import { liveStrip } from "./live_strip.js";
import { ageWords, boundOf, ESTIMATED, LOST } from "./uav_view.js";

const ALERT_ICONS = { critical: "octagon-alert", warning: "triangle-alert", advisory: "info" };

const figure = (value, words, isGuess) => h("div", { class: "live-figure" }, h("strong", {}, value === null ? "—" : `${isGuess ? "~ " : ""}${value}`), h("span", {}, words));

function guessBox(view) {
  const within = t("Estimated, within {bound} (95 of 100 times).", { bound: lengthText(boundOf(view)) });
  const contact = view.contactAt && t("Contact expected by {time}.", { time: clockText(view.contactAt) });
  if (view.kind === LOST) return h("p", { class: "live-guess" }, icon("circle-dashed", "small"), h("span", {}, view.ring ? t("Lost: it may be anywhere within {bound}.", { bound: lengthText(boundOf(view)) }) : t("No report for long: what you see is where it was last.")));
  return h("p", { class: "live-guess" }, icon("circle-dashed", "small"), h("span", {}, [within, contact].filter(Boolean).join(" ")));
}

/** onChoose(id). draw([{ uav, view, route, alerts, commandWords, labels, mission }], chosen). */
export function mountCards({ onChoose }) {
  const list = byId("live-uavs");
  const choose = (id) => () => onChoose(id);

  function make({ uav }) {
    return h("li", { class: "live-card", dataset: { uav: uav.id } });
  }

  function refresh(card, { uav, view, route, alerts, said, labels, mission, isChosen }) {
    card.className = `live-card ${uav.place === null ? "" : `route-${routeNumber(uav.place)}`}${isChosen ? " chosen" : ""}`;
    const hadFocus = card.contains(document.activeElement);
    const worst = alerts[0];
    const nextLabel = view.next ? (labels.get(view.next.target)?.label ?? "") : "";
    const name = h("button", { type: "button", class: "live-name", "aria-pressed": String(isChosen), onclick: choose(uav.id) }, uav.place !== null && h("span", { class: "letter" }, routeLetter(uav.place)), h("strong", {}, uav.name));
    card.replaceChildren(
      h("div", { class: "live-card-head" },
        name,
        view.mode && h("span", { class: "chip" }, view.mode),
        uav.is_simulated && h("span", { class: "chip draft", title: t("No real aircraft") }, t("simulated")),
        h("span", { class: `live-age${view.isLate ? " late" : ""}` }, view.isLate && icon("triangle-alert", "small"), ageWords(view))),
      mission && h("p", { class: "caption" }, mission.name),
      (view.kind === ESTIMATED || view.kind === LOST) && guessBox(view),
      worst && h("p", { class: `live-alert ${worst.level}` }, icon(ALERT_ICONS[worst.level], "small"), h("span", {}, worst.message, alerts.length > 1 && ` ${t("and {count} more", { count: alerts.length - 1 })}`)),
      h("div", { class: "live-figures" },
        figure(view.battery_percent === null ? null : percentText(view.battery_percent), t("battery"), view.isGuess),
        figure(view.height_m === null ? null : heightText(view.height_m), t("over take-off"), view.isGuess),
        figure(view.speed_mps === null ? null : speedText(view.speed_mps), t("speed"), view.isGuess),
        figure(view.endsAt ? clockText(view.endsAt) : null, t("lands"), true)),
      route?.geometry && stripOf(uav, view, route, card.clientWidth),
      (view.next || view.toGo_m !== null) && h("div", { class: "live-next" }, h("span", {}, view.next && t("Next {target}, {time}", { target: nextLabel, time: clockText(view.next.at) })), h("span", {}, view.toGo_m !== null && t("{length} to go", { length: lengthText(view.toGo_m) }))),
      said && h("p", { class: `live-command ${said.level ?? ""}` }, icon(said.image, "small"), h("span", {}, said.words)),
    );
    if (hadFocus) card.querySelector("button")?.focus({ preventScroll: true });
  }

  function stripOf(uav, view, route, width_px) {
    const profile = profileOf(route.waypoints, route.length_m);
    const half_m = view.isGuess && view.ring ? view.ring.along_m : 0;
    const label = view.along_m === null ? t("Route of {name}", { name: uav.name }) : t("{name} has flown {flown} of {whole}", { name: uav.name, flown: lengthText(view.along_m), whole: lengthText(route.length_m) });
    return liveStrip({ profile, length_m: route.length_m, along_m: view.along_m, half_m, kind: view.kind, width_px: Math.max(200, (width_px || 344) - 32), label });
  }

  const draw = keyedList(list, ({ uav }) => uav.id, make, refresh);
  return (rows) => {
    draw(rows);
    byId("live-empty").hidden = rows.length > 0;
    byId("live-count").textContent = rows.length || "";
  };
}
