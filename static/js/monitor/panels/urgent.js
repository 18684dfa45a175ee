/** On a phone: the most urgent alert, or else another plan that waits for a decision, over the map, with the way to it. */

import { byId, h, icon } from "../../dom.js";
import { alertsInOrder, isOpenAlert, isUnanswered, pinnedAlerts } from "../../domain/order.js";
import { t } from "../../text.js";
import { exactClockText } from "../../units.js";
import { messageWords } from "../text/alert_text.js";
import { causeWords, isUndecided } from "../text/offer_text.js";

/** @import { MonitorStore } from "../types.d.ts" */

/** @param {MonitorStore} store @param {{ open: () => void }} on open: shows the alerts and offers */
export function mountUrgent(store, { open }) {
  const words = h("span", {});
  const box = h(
    "div",
    { class: "urgent float", hidden: true },
    words,
    h("button", { type: "button", class: "text-button", onclick: open }, t("Open|verb")),
  );
  byId("map").parentElement?.append(box);
  store.listen(["alerts", "offers", "uavs", "now_ms"], ({ alerts, offers, uavs, now_ms }) => {
    const unanswered = pinnedAlerts(alerts).filter((alert) => isUnanswered(alert) && alert.level !== "advisory");
    const [worst] = alertsInOrder(unanswered);
    const offer = offers.find((one) => isUndecided(one) && one.state !== "computing");
    box.hidden = !worst && !offer;
    if (worst) {
      box.className = `urgent float ${isOpenAlert(worst) ? worst.level : "known"}`;
      words.replaceChildren(
        icon(worst.level === "critical" ? "octagon-alert" : "triangle-alert"),
        h(
          "strong",
          {},
          messageWords(
            worst,
            uavs.find(({ id }) => id === worst.uav),
            now_ms,
          ),
        ),
        worst.closed_at ? h("span", {}, t("Ended {time}.", { time: exactClockText(worst.closed_at) })) : "",
      );
    } else if (offer) {
      box.className = "urgent float offered";
      words.replaceChildren(
        icon("waypoints"),
        h("span", {}, h("strong", {}, `${t("Re-plan offered")}. `), `${causeWords(offer)}.`),
      );
    }
  });
}
