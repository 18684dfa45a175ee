/** One row of the list: drawing, name to be changed in its place, figures, and what can be done. */

import { h, icon } from "../dom.js";
import { routeLetter, routeNumber } from "../domain/palette.js";
import { menuOf, toggleMenu } from "../page/chrome.js";
import { simulatedMark } from "../simulated.js";
import { t, tn } from "../text.js";
import { durationText, exactText, lengthText, whenText } from "../units.js";
import { sketch } from "./sketch.js";

export const STATES = {
  draft: t("Draft"),
  planned: t("Planned"),
  approved: t("Approved"),
  dispatched: t("Dispatched"),
  active: t("Active"),
  completed: t("Completed"),
  aborted: t("Aborted"),
  failed: t("Failed"),
};
const EDITABLE = ["draft", "planned"];
const MOST_DOTS = 24;

/** "39 of 46 targets" where a plan leaves some out. */
function reachedWords({ target_count, unassigned_count }) {
  if (!unassigned_count) return tn(target_count, "{count} target", "{count} targets");
  return tn(target_count, "{reached} of {count} target", "{reached} of {count} targets", {
    reached: target_count - unassigned_count,
  });
}

/** The name turned into a field: Enter keeps, Escape leaves it as it was. */
export function editName(cell, mission, rename) {
  const link = cell.querySelector("a, strong");
  const field = h("input", {
    class: "input",
    maxlength: "200",
    value: mission.name,
    "aria-label": t("New name of {name}", { name: mission.name }),
  });
  let isDone = false;
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

/** acts: { isChosen, choose, rename, duplicate, remove, restore }. */
export function missionRow(mission, { canPlan, acts }) {
  const address = `/missions/${mission.id}`;
  const isDeleted = Boolean(mission.deleted_at);
  const isPlanned = mission.total_length_m !== null && mission.total_length_m !== undefined;
  const mayChange = canPlan && EDITABLE.includes(mission.state);
  const name = h(
    "td",
    { class: "name" },
    isDeleted ? h("strong", { tabindex: "-1" }, mission.name) : h("a", { href: address }, mission.name),
    h(
      "span",
      { class: "caption" },
      mission.author ?? "",
      mission.is_simulated && simulatedMark(),
      mission.is_stale && staleMark(mission),
    ),
  );
  const quick = (label, image, act) =>
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
      menuOf(
        mission.name,
        [
          { icon: "map", label: t("Open"), act: () => void (location.href = address) },
          mayChange && { icon: "pencil", label: t("Rename"), act: () => editName(name, mission, acts.rename) },
          canPlan && { icon: "copy", label: t("Duplicate"), act: acts.duplicate },
          { icon: "link", label: t("Copy the address"), act: acts.copyAddress },
          mayChange && { icon: "trash-2", label: t("Delete"), act: acts.remove },
        ].filter(Boolean),
      ),
    ),
  );
  const does = isDeleted
    ? canPlan &&
      h(
        "button",
        { type: "button", class: "button", onclick: acts.restore },
        icon("archive-restore", "small"),
        t("Bring back"),
      )
    : [
        mayChange && quick(t("Rename"), "pencil", () => editName(name, mission, acts.rename)),
        canPlan && quick(t("Duplicate"), "copy", acts.duplicate),
        more,
      ];
  return h(
    "tr",
    {
      dataset: { id: mission.id },
      class: isDeleted ? "deleted" : null,
      onclick: (event) => {
        if (!isDeleted && !event.target.closest("a, button, input, label, .choice")) location.href = address;
      },
    },
    canPlan &&
      h(
        "td",
        { class: "choice" },
        h(
          "label",
          {},
          h("input", {
            type: "checkbox",
            class: "check",
            checked: acts.isChosen,
            "aria-label": t("Choose {name}", { name: mission.name }),
            onchange: (event) => acts.choose(event.target.checked),
          }),
        ),
      ),
    h("td", { class: "drawing" }, sketch(mission)),
    name,
    h("td", { class: "state" }, h("span", { class: `chip ${mission.state}` }, STATES[mission.state] ?? mission.state)),
    h(
      "td",
      { class: "targets" },
      mission.target_count > 0 &&
        mission.target_count <= MOST_DOTS &&
        h(
          "div",
          { class: "dots", "aria-hidden": "true" },
          Array.from({ length: mission.target_count }, (_, place) =>
            h("i", { class: place < mission.target_count - mission.unassigned_count ? null : "missed" }),
          ),
        ),
      h("span", { class: "caption" }, reachedWords(mission)),
    ),
    h(
      "td",
      { class: "uavs" },
      mission.uav_count
        ? h(
            "span",
            { class: "letters", role: "img", "aria-label": tn(mission.uav_count, "{count} UAV", "{count} UAVs") },
            Array.from({ length: mission.uav_count }, (_, sequence) =>
              h(
                "span",
                { class: `letter route-${routeNumber(sequence)}`, "aria-hidden": "true" },
                routeLetter(sequence),
              ),
            ),
          )
        : h("span", { class: "caption" }, t("none")),
    ),
    h("td", { class: "number distance" }, isPlanned ? lengthText(mission.total_length_m) : "—"),
    h("td", { class: "number time" }, isPlanned ? durationText(mission.duration_s) : "—"),
    h("td", { class: "changed", title: exactText(mission.updated_at) }, whenText(mission.updated_at)),
    h("td", { class: "acts" }, does),
  );
}
