/** One row of the list: drawing, name that can be edited in place, figures, and acts. */

import { find, h, icon } from "../dom.js";
import { routeLetter, routeNumber } from "../domain/palette.js";
import { MISSION_STATES, plannedChip, REHEARSAL_FAILED } from "../domain/planned_state.js";
import { menuOf, toggleMenu } from "../page/chrome.js";
import { simulatedMark } from "../simulated.js";
import { t, tn } from "../text.js";
import { durationText, exactText, lengthText, whenText } from "../units.js";
import { sketch } from "./sketch.js";

/** @import { MissionSummary } from "../api_types.d.ts" */

/**
 * @typedef {object} RowActs
 * @property {boolean} isChosen
 * @property {(isChosen: boolean) => void} choose
 * @property {(name: string) => unknown} rename
 * @property {() => unknown} duplicate
 * @property {() => unknown} remove
 * @property {() => unknown} restore
 * @property {() => unknown} copyAddress
 */

const EDITABLE = ["draft", "planned"];
const MAX_DOTS = 24;

/** "39 of 46 targets" where a plan leaves some out. @param {MissionSummary} mission */
function reachedWords({ target_count, unassigned_count }) {
  if (!unassigned_count) return tn(target_count, "{count} target", "{count} targets");
  return tn(target_count, "{reached} of {count} target", "{reached} of {count} targets", {
    reached: target_count - unassigned_count,
  });
}

/**
 * Turns the name into a field: Enter keeps, Escape leaves it as it was.
 *
 * @param {HTMLElement} cell
 * @param {MissionSummary} mission
 * @param {RowActs["rename"]} rename
 */
function editName(cell, mission, rename) {
  const link = find(cell, "a, strong", HTMLElement);
  const field = h("input", {
    class: "input",
    maxlength: "200",
    value: mission.name,
    "aria-label": t("New name of {name}", { name: mission.name }),
  });
  let isDone = false;
  /** @param {boolean} keep */
  const end = (keep) => {
    if (isDone) return;
    isDone = true;
    const name = field.value.trim();
    field.replaceWith(link);
    link.focus();
    if (keep && name && name !== mission.name) rename(name);
  };
  field.addEventListener("keydown", (event) => {
    if (event.key === "Enter") end(true);
    if (event.key === "Escape") end(false);
    event.stopPropagation();
  });
  field.addEventListener("click", (event) => event.stopPropagation());
  field.addEventListener("blur", () => end(true));
  link.replaceWith(field);
  field.select();
}

const demoMark = () =>
  h("span", { class: "simulated-mark", title: t("Demo data, flown by simulated UAVs") }, t("Demo"));

/** @param {MissionSummary} mission */
function staleMark({ has_other_uavs }) {
  const [words, title] = has_other_uavs
    ? [
        t("UAV changed since"),
        t("A UAV has other figures than it was planned with, or flies no more. Open it to see which."),
      ]
    : [
        t("Ground changed since"),
        t("Assets, zones or terrain were changed after this was planned. Open it to see what that touches."),
      ];
  return h("span", { class: "stale", title }, icon("triangle-alert", "small"), words);
}

/**
 * A row of the list.
 *
 * @param {MissionSummary} mission
 * @param {{ canPlan: boolean, acts: RowActs }} how
 */
export function missionRow(mission, { canPlan, acts }) {
  const address = `/missions/${mission.id}`;
  const isDeleted = Boolean(mission.deleted_at);
  const isPlanned = mission.total_length_m !== null;
  const name = nameCell(mission, address);
  return h(
    "tr",
    {
      dataset: { id: mission.id },
      class: isDeleted ? "deleted" : null,
      onclick: (event) => {
        const at = /** @type {Element} */ (event.target);
        if (!isDeleted && !at.closest("a, button, input, label, .choice")) location.href = address;
      },
    },
    canPlan && choiceCell(mission, acts),
    h("td", { class: "drawing" }, sketch(mission)),
    name,
    h("td", { class: "state" }, stateChips(mission)),
    targetsCell(mission),
    uavsCell(mission),
    h("td", { class: "number distance" }, lengthText(mission.total_length_m)),
    h("td", { class: "number time" }, isPlanned ? durationText(mission.duration_s) : "—"),
    h("td", { class: "changed", title: exactText(mission.updated_at) }, whenText(mission.updated_at)),
    h("td", { class: "acts" }, isDeleted ? canPlan && restoreButton(acts) : actButtons(mission, canPlan, acts, name)),
  );
}

/** @param {MissionSummary} mission @param {string} address */
function nameCell(mission, address) {
  return h(
    "td",
    { class: "name" },
    mission.deleted_at ? h("strong", { tabindex: "-1" }, mission.name) : h("a", { href: address }, mission.name),
    h(
      "span",
      { class: "caption" },
      mission.author ?? "",
      mission.is_demo ? demoMark() : mission.is_simulated && simulatedMark(),
      mission.is_stale && staleMark(mission),
    ),
  );
}

/** @param {MissionSummary} mission @param {RowActs} acts */
function choiceCell(mission, acts) {
  const box = h("input", {
    type: "checkbox",
    class: "check",
    checked: acts.isChosen,
    "aria-label": t("Choose {name}", { name: mission.name }),
  });
  box.addEventListener("change", () => acts.choose(box.checked));
  return h("td", { class: "choice" }, h("label", {}, box));
}

/** @param {MissionSummary} mission */
function targetsCell(mission) {
  const count = mission.target_count;
  return h(
    "td",
    { class: "targets" },
    count > 0 &&
      count <= MAX_DOTS &&
      h(
        "div",
        { class: "dots", "aria-hidden": "true" },
        Array.from({ length: count }, (_, place) =>
          h("i", { class: place < count - mission.unassigned_count ? null : "missed" }),
        ),
      ),
    h("span", { class: "caption" }, reachedWords(mission)),
  );
}

/** @param {MissionSummary} mission */
function uavsCell({ uav_count: count }) {
  return h(
    "td",
    { class: "uavs" },
    count
      ? h(
          "span",
          { class: "letters", role: "img", "aria-label": tn(count, "{count} UAV", "{count} UAVs") },
          Array.from({ length: count }, (_, sequence) =>
            h("span", { class: `letter route-${routeNumber(sequence)}`, "aria-hidden": "true" }, routeLetter(sequence)),
          ),
        )
      : h("span", { class: "caption" }, t("none")),
  );
}

/** @param {RowActs} acts */
const restoreButton = (acts) =>
  h(
    "button",
    { type: "button", class: "button", onclick: acts.restore },
    icon("archive-restore", "small"),
    t("Bring back"),
  );

/**
 * The quick buttons and the menu with all acts.
 *
 * @param {MissionSummary} mission
 * @param {boolean} canPlan
 * @param {RowActs} acts
 * @param {HTMLElement} name the cell in which it is renamed
 */
function actButtons(mission, canPlan, acts, name) {
  const mayChange = canPlan && EDITABLE.includes(mission.state);
  const edit = () => editName(name, mission, acts.rename);
  const more = h(
    "button",
    {
      type: "button",
      class: "icon-button",
      "aria-label": t("More for {name}", { name: mission.name }),
      "aria-haspopup": "true",
      "aria-expanded": "false",
    },
    icon("ellipsis"),
  );
  more.addEventListener("click", () =>
    toggleMenu(more, () =>
      menuOf(mission.name, [
        { icon: "map", label: t("Open|verb"), act: () => location.assign(`/missions/${mission.id}`) },
        ...(mayChange ? [{ icon: "pencil", label: t("Rename"), act: edit }] : []),
        ...(canPlan ? [{ icon: "copy", label: t("Duplicate"), act: acts.duplicate }] : []),
        { icon: "link", label: t("Copy link"), act: acts.copyAddress },
        ...(mayChange ? [{ icon: "trash-2", label: t("Delete"), act: acts.remove }] : []),
      ]),
    ),
  );
  return [
    mayChange && quickButton(mission, t("Rename"), "pencil", edit),
    canPlan && quickButton(mission, t("Duplicate"), "copy", acts.duplicate),
    more,
  ];
}

/** @param {MissionSummary} mission @param {string} label @param {string} image @param {() => unknown} act */
const quickButton = (mission, label, image, act) =>
  h(
    "button",
    {
      type: "button",
      class: "icon-button quick",
      "aria-label": `${label}: ${mission.name}`,
      title: label,
      onclick: act,
    },
    icon(image),
  );

/** @param {Pick<MissionSummary, "state" | "target_count" | "unassigned_count" | "has_failed_rehearsal">} mission */
function stateChips({ state, target_count, unassigned_count, has_failed_rehearsal }) {
  const { className, words } =
    state === "planned"
      ? plannedChip(target_count, unassigned_count)
      : { className: `chip ${state}`, words: MISSION_STATES[state] ?? state };
  return [
    h("span", { class: className }, words),
    has_failed_rehearsal && [" ", h("span", { class: "chip failed" }, REHEARSAL_FAILED)],
  ];
}
