/** On a phone: the most urgent alert over the map, with the way to it. */

import { byId, h, icon } from "../../dom.js";
import { t } from "../../text.js";
import { alertsInOrder, isUnanswered } from "../order.js";

/** open() shows the alerts. */
export function mountUrgent(store, { open }) {
  const words = h("span", {});
  const box = h("div", { class: "urgent float", hidden: true }, words, h("button", { type: "button", class: "text-button", onclick: open }, t("Decide")));
  byId("map").parentElement.append(box);
  store.listen(["alerts"], ({ alerts }) => {
    const [worst] = alertsInOrder(alerts.filter(isUnanswered)).filter(({ level }) => level !== "advisory");
    box.hidden = !worst;
    if (!worst) return;
    box.className = `urgent float ${worst.level}`;
    words.replaceChildren(icon(worst.level === "critical" ? "octagon-alert" : "triangle-alert"), h("strong", {}, worst.message));
  });
}
