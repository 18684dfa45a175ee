/** Commands for the chosen UAV, over the map's lower edge; on a phone at thumb height. */

import { byId, h, icon } from "../../dom.js";
import { KINDS } from "../../domain/flying.js";
import { flyingUavs } from "../../domain/in_air.js";
import { routeLetter, routeNumber } from "../../domain/palette.js";
import { t } from "../../text.js";
import { isHeld } from "../uav_words.js";

const BUTTONS = [
  { kind: "pause", image: "pause", words: KINDS.pause },
  { kind: "hold", image: "hand", words: KINDS.hold, isWide: true },
  { kind: "return", image: "house", words: KINDS.return },
  { kind: "land", image: "plane-landing", words: KINDS.land },
  { kind: "change-speed", image: "gauge", words: t("Speed"), isWide: true },
  { kind: "abort", image: "octagon-alert", words: KINDS.abort, isDanger: true },
];

/** commanding: see commanding.js. Returns the keys. */
export function mountCommandBar(store, commanding) {
  const letter = h("span", { class: "letter" });
  const name = h("strong", {});
  const buttons = BUTTONS.map(({ kind, image, words, isWide, isDanger }) => {
    const button = h(
      "button",
      {
        type: "button",
        class: `command-button ${isWide ? "wide" : ""} ${isDanger ? "danger" : ""}`,
        "data-kind": kind,
        onclick: () => void commanding.ask(store.state.chosen, button.dataset.kind, button),
      },
      icon(image),
      h("span", {}, words),
    );
    return button;
  });
  const [pause] = buttons;
  const bar = h(
    "div",
    { class: "command-bar float", role: "group", hidden: true },
    h("span", { class: "command-who" }, letter, name),
    buttons,
  );
  byId("main").append(bar);
  const chosenFlyer = (state) => flyingUavs(state).find(({ id }) => id === state.chosen) ?? null;

  store.listen(["chosen", "uavs", "missions"], (state) => {
    const uav = chosenFlyer(state);
    bar.hidden = uav === null;
    document.documentElement.toggleAttribute("data-commanding", uav !== null);
    if (!uav) return;
    bar.setAttribute("aria-label", t("Commands to {name}", { name: uav.name }));
    letter.hidden = uav.place === null;
    if (uav.place !== null) {
      letter.textContent = routeLetter(uav.place);
      letter.className = `letter route-${routeNumber(uav.place)}`;
    }
    name.textContent = uav.name;
    const kind = isHeld(uav) ? "resume" : "pause";
    if (pause.dataset.kind === kind) return;
    pause.dataset.kind = kind;
    pause.replaceChildren(icon(kind === "resume" ? "play" : "pause"), h("span", {}, KINDS[kind]));
  });
  for (const [id, kind] of [
    ["pause-all", "pause"],
    ["return-all", "return"],
  ])
    byId(id).addEventListener("click", () => void commanding.askAll(kind, byId(id)));
  store.listen(["uavs", "missions"], (state) =>
    ["pause-all", "return-all"].forEach((id) => (byId(id).disabled = flyingUavs(state).length === 0)),
  );

  const key = (keys, kind, words) => ({
    keys: [keys],
    words,
    act: () => {
      const uav = chosenFlyer(store.state);
      if (!uav) return false;
      void commanding.ask(
        uav.id,
        kind,
        buttons.find((button) => button.dataset.kind === kind),
      );
      return true;
    },
  });
  return [
    key("shift+p", "pause", t("Pause the chosen UAV")),
    key("shift+h", "hold", t("Hold the chosen UAV")),
    key("shift+r", "return", t("Return the chosen UAV")),
    key("shift+l", "land", t("Land the chosen UAV here")),
  ];
}
