/** What is chosen, in full: its facts, what can be done with it, a UAV's credentials and missions. */

import { get } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { simulatedMark } from "../simulated.js";
import { t, tn } from "../text.js";
import { whenText } from "../units.js";
import { mountConnection } from "./connection.js";
import { mountCredentials } from "./credentials.js";
import { mountTypeAirframe } from "./type_airframe.js";
import { mountTypeLimits } from "./type_limits.js";
import { MISSION_STATES, stateChip } from "./words.js";

/** acts: { back, edit, put(state), remove, refresh, showUavs } */
export function mountPanel({ canPlan, acts }) {
  const panel = byId("fleet-panel");
  const back = () =>
    h(
      "button",
      { type: "button", class: "text-button back", onclick: acts.back },
      icon("arrow-left", "small"),
      t("All of them"),
    );
  const button = (name, words, act, kind = "") =>
    h("button", { type: "button", class: `button ${kind}`, onclick: act }, icon(name, "small"), words);

  function stateButtons(uav) {
    if (uav.state === "retired") return [button("archive-restore", t("Bring back"), () => acts.put("active"))];
    return [
      uav.state === "active"
        ? button("wrench", t("Maintenance"), () => acts.put("maintenance"))
        : button("check", t("Back in service"), () => acts.put("active")),
      button("archive", t("Retire"), () => acts.put("retired")),
    ];
  }

  function missionRows(missions) {
    return missions.map((mission) =>
      h(
        "li",
        {},
        h(
          "div",
          { class: "what" },
          h("a", { href: `/missions/${mission.id}` }, mission.name),
          h("span", { class: "caption" }, whenText(mission.updated_at)),
        ),
        h("span", { class: `chip ${mission.state}` }, MISSION_STATES[mission.state] ?? mission.state),
      ),
    );
  }

  /** The newest missions first; more on demand. */
  async function fillMissions(list, none, address) {
    const { data } = await get(address);
    list.append(...missionRows(data.results));
    none.hidden = list.children.length > 0;
    if (!data.next) return;
    const more = h(
      "button",
      {
        type: "button",
        class: "text-button",
        onclick: () => (more.parentElement.remove(), fillMissions(list, none, data.next)),
      },
      t("Earlier missions"),
    );
    list.append(h("li", {}, more));
  }

  function show(kind, row) {
    const isUav = kind.tab === "uavs";
    const title = h("h2", { tabindex: -1 }, row.name);
    const connection = h("div", { class: "connection" });
    const credentials = h("ul", { class: "plain-list" });
    const missions = h("ul", { class: "plain-list" });
    const limits = h("div", { class: "type-limits" });
    const airframe = h("div", { class: "type-airframe" });
    const none = h("p", { class: "quiet-text", hidden: true }, t("No mission uses it yet."));
    panel.hidden = false;
    panel.replaceChildren(
      ...[
        back(),
        h(
          "div",
          { class: "panel-head" },
          title,
          isUav && row.is_simulated && simulatedMark(),
          isUav && stateChip(row.state),
        ),
        isUav &&
          row.state === "retired" &&
          h("p", { class: "quiet-text" }, t("It is not offered for new missions and does not connect.")),
        canPlan &&
          h(
            "div",
            { class: "panel-acts" },
            button("pencil", t("Edit"), acts.edit),
            isUav && stateButtons(row),
            h(
              "button",
              {
                type: "button",
                class: "icon-button",
                "aria-label": t("Delete {name}", row),
                title: t("Delete"),
                onclick: acts.remove,
              },
              icon("trash-2"),
            ),
          ),
        h("dl", { class: "facts" }, kind.facts(row)),
        !isUav &&
          row.uav_count > 0 &&
          h(
            "p",
            {},
            h(
              "button",
              { type: "button", class: "text-button", onclick: () => acts.showUavs(kind.tab, row.id) },
              tn(row.uav_count, "Show the UAV", "Show the {count} UAVs"),
            ),
          ),
        kind.tab === "types" && h("h3", {}, t("Alerts")),
        kind.tab === "types" && limits,
        kind.tab === "types" && h("h3", {}, t("Simulation")),
        kind.tab === "types" && airframe,
        isUav && h("h3", {}, t("Link")),
        isUav && connection,
        isUav && credentials,
        isUav && h("h3", {}, t("Missions")),
        isUav && missions,
        isUav && none,
      ].filter(Boolean),
    );
    if (isUav) {
      mountConnection(connection, row).catch(acts.failed);
      mountCredentials(credentials, row, { canPlan, onChange: acts.refresh }).catch(acts.failed);
      fillMissions(missions, none, `/uavs/${row.id}/missions`).catch(acts.failed);
    }
    if (kind.tab === "types") {
      mountTypeLimits(limits, row, { canPlan, failed: acts.failed }).catch(acts.failed);
      mountTypeAirframe(airframe, row, { canPlan, failed: acts.failed }).catch(acts.failed);
    }
    return title;
  }

  return {
    show,
    edit(title, form) {
      panel.hidden = false;
      panel.replaceChildren(back(), h("div", { class: "panel-head" }, h("h2", { tabindex: -1 }, title)), form.element);
      panel.scrollTop = 0;
    },
    close() {
      panel.hidden = true;
      panel.replaceChildren();
    },
  };
}

/** Somebody else was faster: what they changed, and what can be done. seen and theirs are bodies. */
export function conflictNotice({ who, seen, theirs, form, onTheirs, onMine }) {
  const changed = Object.keys(theirs).filter((name) => JSON.stringify(theirs[name]) !== JSON.stringify(seen[name]));
  return h(
    "div",
    { class: "notice critical", role: "alert" },
    icon("circle-alert"),
    h(
      "div",
      {},
      h(
        "p",
        {},
        h("strong", {}, t("Changed by {who} in the meantime.", { who })),
        ` ${t("Nothing of yours is stored yet.")}`,
      ),
      h(
        "dl",
        { class: "differences" },
        changed.map((name) => [
          h("dt", {}, form.label(name)),
          h("dd", {}, form.words(name, seen[name])),
          h("dd", {}, `→ ${form.words(name, theirs[name])}`),
        ]),
      ),
      h(
        "p",
        {},
        h("button", { type: "button", class: "text-button", onclick: onTheirs }, t("Take theirs")),
        h("button", { type: "button", class: "text-button", onclick: onMine }, t("Store mine over it")),
      ),
    ),
  );
}
