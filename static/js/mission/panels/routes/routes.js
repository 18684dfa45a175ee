/** The dock: the sentence, then a strip for each UAV, all on one axis; on request the strip of the plan before under each. */

import { byId, h, icon } from "../../../dom.js";
import { routeNumber } from "../../../domain/palette.js";
import { profileOf } from "../../../domain/route_profile.js";
import { t, tn } from "../../../text.js";
import { durationText, lengthText } from "../../../units.js";
import { counterpart, profileOfSummary } from "../../compare.js";
import { timeAt } from "../../flight_options.js";
import { lockOf, ordersOf, stopsWished, wishedOrders } from "../../locks.js";
import { checkStateOf, checkText } from "../../lost_link.js";
import {
  endingOf,
  isPlanCurrent,
  isPlanInSight,
  lastPlanOf,
  pointAlong,
  qualityOf,
  routesOf,
  sentenceOf,
  stripLabel,
  wishWordsOf,
} from "../../plan_view.js";
import { GROUNDING } from "../../plan_words.js";
import { batteryOf, delayText, landing_s, separationOf, staysOf, staysText, stayText } from "../../route_times.js";
import { uavsByName } from "../../selection.js";
import { paleStrip, spanStrip, stripAxis, stripTable } from "../../span_strip.js";
import { createPillDrag } from "../../strip_drag.js";
import { passedZones } from "../../zones_passed.js";

const BESIDE_PX = 184 + 84 + 72 + 80 + 4 * 12 + 32; // name, figures, hand and Why, gaps and edges, as in planning.css
const BATTERY_PX = 76 + 12; // where one has a battery
const LENGTH_PX = 84 + 12;
const LEAST_STRIP_PX = 200; // else length and battery give way
const MOST_LOOKED_AT = 12; // routes beside which zones are looked for at once

/** One that cannot take off; the notice and the row of the UAV say which. */
const isGrounded = ({ result }, { sequence }) =>
  (result.warnings ?? []).some(({ code, uav }) => GROUNDING.includes(code) && uav === sequence);

/** "+1.2 km", "−3 min", "=": more or less than before. */
export function moreOrLess(difference, least, textOf) {
  if (Math.abs(difference) < least) return "=";
  return `${difference > 0 ? "+" : "−"}${textOf(Math.abs(difference))}`;
}

/** What the grid leaves beside name and all figures. */
const roomBesideAll = (dock) =>
  dock.querySelector(".dock-main").clientWidth - BESIDE_PX - (dock.classList.contains("with-battery") ? BATTERY_PX : 0);

/** Room for a strip: on a phone all there is, where the dock is narrow without length and battery. */
export function stripRoom(dock) {
  const width = dock.querySelector(".dock-main").clientWidth;
  if (matchMedia("(max-width: 720px)").matches) return Math.max(160, width - 32);
  const room = roomBesideAll(dock);
  return Math.max(160, room < LEAST_STRIP_PX ? width - BESIDE_PX + LENGTH_PX : room);
}

export function mountRoutes(store, actions, { canPlan, grounds, showPoint }) {
  const dock = byId("dock");
  const list = byId("route-list");
  const strips = new Map(); // sequence → what spanStrip gives
  const zonesOf = new WeakMap(); // waypoints of a route → stretches beside zones
  let width_px = 0;
  let isPointed = false; // a place of a strip is shown on the map
  let wishes = []; // the order of each route as it would be with what is locked
  const grab = createPillDrag(list, { strips, drop });

  function drop(keys, { sequence, index }) {
    store.update({ litTarget: null }); // a finger does not leave
    actions.placeTargets(keys, { uav: store.state.plan.result.routes[sequence].uav, index });
  }

  function row(route, state, before) {
    const isUsed = Boolean(route.geometry);
    const look = () => store.update({ lookedAt: route.sequence });
    const leave = () => store.update({ lookedAt: null });
    const old = before && counterpart(route, before);
    const second = isUsed
      ? [
          tn(route.targets.length, "{count} target", "{count} targets"),
          route.by_hand?.length > 0 && t("changed by hand"),
          staysText(route),
          delayText(route),
          endingOf(route),
        ]
          .filter(Boolean)
          .join(" · ")
      : isGrounded(state.plan, route)
        ? t("cannot take off")
        : state.plan.result.unassigned.length
          ? t("reaches none of what is left")
          : t("not needed");
    const delta = (words) => old && h("small", {}, words);
    const landing = isUsed && state.plan.result.departs_at && !old ? landing_s(route) : null;
    const battery = isUsed ? batteryOf(route) : null;
    return h(
      "li",
      {
        class: `route route-${routeNumber(route.sequence)}`,
        dataset: { sequence: route.sequence },
        onpointerenter: look,
        onpointerleave: leave,
        onfocusin: look,
        onfocusout: leave,
      },
      h(
        "button",
        {
          type: "button",
          class: "who",
          disabled: !isUsed,
          "aria-pressed": String(state.chosenRoute === route.sequence),
          title: second,
          onclick: () =>
            store.update({ chosenRoute: store.state.chosenRoute === route.sequence ? null : route.sequence }),
        },
        h("span", { class: "letter" }, route.letter),
        h("span", {}, h("strong", {}, route.name), h("small", {}, second)),
      ),
      h(
        "div",
        { class: "strip-place" },
        (isUsed || wishes[route.sequence].length > 0) && strip(route, state, longest(state, before)),
        old?.length_m > 0 && oldStrip(old, longest(state, before)),
      ),
      h(
        "span",
        { class: "figure length-figure" },
        isUsed ? lengthText(route.length_m) : "—",
        delta(old && moreOrLess(route.length_m - old.length_m, 50, lengthText)),
      ),
      h(
        "span",
        { class: "figure" },
        isUsed ? durationText(route.duration_s) : "—",
        delta(old && moreOrLess(route.duration_s - old.duration_s, 30, durationText)),
        landing !== null && h("small", {}, t("until {time}", { time: timeAt(state.plan.result.departs_at, landing) })),
      ),
      dock.classList.contains("with-battery") &&
        h(
          "span",
          {
            class: "figure battery-figure",
            title: battery ? t("{percent} left, {energy} used", { percent: battery.left, energy: battery.used }) : null,
          },
          battery?.left ?? "—",
          battery && h("small", {}, t("at landing")),
        ),
      isUsed &&
        h(
          "span",
          { class: "route-acts" },
          canPlan &&
            h(
              "button",
              {
                type: "button",
                class: "icon-button tight",
                "aria-label": t("Change the route of {name} by hand", { name: route.name }),
                title: route.charging?.length
                  ? t("A route with stops to charge cannot be changed by hand.")
                  : t("Change by hand"),
                disabled: Boolean(route.charging?.length),
                onclick: () => void actions.beginByHand(route.sequence),
              },
              icon("hand", "small"),
            ),
          h(
            "button",
            {
              type: "button",
              class: "text-button why-button",
              "aria-label": t("Why does {name} fly this route?", { name: route.name }),
              onclick: () => store.update({ why: { route: route.sequence } }),
            },
            t("Why?"),
          ),
        ),
    );
  }

  function longest({ plan }, before) {
    return Math.max(plan.result.longest_route_m, ...(before?.routes ?? []).map((route) => route.length_m));
  }

  /** What keys mean on this page: targets of the plan, and those picked since. */
  const targetOf = ({ plan, selection }, key) =>
    plan.targets.find((target) => target.key === key) ?? selection.targets.find((target) => target.key === key);

  /** The pills of a route: as planned, and once a wish is not planned yet, where it would be. */
  function stopsOf(route, { plan, selection }, planned) {
    const stops = planned.map(({ target, at }) => ({ target: plan.targets[target]?.key ?? `${target}`, at }));
    const isAsPlanned = wishes[route.sequence].join() === ordersOf(plan)[route.sequence].targets.join();
    const shown = isAsPlanned
      ? stops
      : stopsWished(stops, wishes[route.sequence], route.length_m || plan.result.longest_route_m);
    return shown.map((stop) => ({ ...stop, isLocked: lockOf(selection, stop.target) !== null }));
  }

  function strip(route, state, longest_m) {
    const { plan } = state;
    const { targets } = plan;
    const { waypoints, length_m } = route;
    const drawn = spanStrip({
      waypoints,
      length_m,
      longest_m,
      width_px,
      label: stripLabel(
        route,
        wishes[route.sequence].map((key) => ({
          ...targetOf(state, key),
          isLocked: lockOf(state.selection, key) !== null,
        })),
      ),
      stopsOf: (planned) => stopsOf(route, state, planned),
      zones: zonesOf.get(waypoints) ?? [],
      waits: staysOf(route).map((stay) => ({ ...stay, words: stayText(stay) })),
      onAlong: (at_m) =>
        store.update({ along: at_m === null ? null : { sequence: route.sequence, at_m, isWished: false } }),
      onTarget: (key) => store.update({ litTarget: key }),
      grab: canPlan && uavsByName(state.selection).some(({ name }) => name === route.name) ? grab : undefined,
    });
    strips.set(route.sequence, drawn);
    return [drawn.element, h("div", {}, stripTable({ waypoints, length_m, targets, name: route.name }))];
  }

  function oldStrip(old, longest_m) {
    const words = t("In the last plan {name} flew {length} in {time}.", {
      name: old.uav,
      length: lengthText(old.length_m),
      time: durationText(old.duration_s),
    });
    return paleStrip({ profile: profileOfSummary(old), longest_m, width_px, label: words });
  }

  function draw(state) {
    dock.hidden = !state.plan;
    if (!state.plan) return;
    const { sentence, facts } = sentenceOf(state.plan);
    byId("plan-sentence").textContent = `${sentence}.`;
    byId("plan-facts").textContent = isPlanCurrent(state)
      ? facts
      : `${facts} · ${isPlanInSight(state) ? t("before your last change") : t("for the selection before")}`;
    dock.classList.toggle(
      "with-battery",
      state.plan.result.routes.some((route) => batteryOf(route)),
    );
    width_px = stripRoom(dock);
    dock.classList.toggle("tight", roomBesideAll(dock) < LEAST_STRIP_PX);
    const last = lastPlanOf(state);
    const before = state.why?.compare ? last : null;
    dock.classList.toggle("comparing", Boolean(before));
    const compare = byId("compare-plans");
    compare.hidden = !last;
    compare.setAttribute("aria-pressed", String(Boolean(before)));
    strips.clear();
    wishes = wishesOf(state);
    drawQuality(state);
    const buttons = () => [...list.querySelectorAll("button")];
    const focused = buttons().indexOf(document.activeElement);
    list.replaceChildren(...routesOf(state.plan).map((route) => row(route, state, before)));
    if (focused >= 0) buttons()[focused]?.focus({ preventScroll: true });
    byId("route-axis").replaceChildren(h("div", {}, stripAxis(longest(state, before) || 1, width_px)));
    mark(state);
  }

  /** Orders by the place of each route; what is locked to a UAV without a route is not drawn. */
  function wishesOf({ plan, selection }) {
    const known = new Set(selection.targets.map(({ key }) => key));
    const wished = wishedOrders(ordersOf(plan), selection.locks ?? []);
    return plan.result.routes.map((_, sequence) =>
      wished[sequence].targets.filter((key) => known.has(key) || plan.targets.some((target) => target.key === key)),
    );
  }

  /** How good the plan is, how its UAVs are kept apart, what locking costs, and the way back. */
  function drawQuality(state) {
    const isCurrent = isPlanCurrent(state);
    const quality = isCurrent ? qualityOf(state.plan.result) : null;
    const locked = state.selection.locks?.length ?? 0;
    const wish = isCurrent ? wishWordsOf(state.plan.result) : locked ? t("Your wish is not planned yet.") : "";
    const acts = canPlan &&
      locked > 0 && [
        !isCurrent && h("button", { type: "button", class: "text-button", onclick: actions.plan }, t("Plan again")),
        h("button", { type: "button", class: "text-button", onclick: actions.unlockAll }, t("Unlock all")),
      ];
    const place = byId("plan-quality");
    const separation = isCurrent ? separationOf(state.plan.result) : null;
    const linkState = checkStateOf(state.selection.lost_link, state.plan, isCurrent);
    const isLost = linkState === "lost";
    place.hidden = !quality && !locked && !separation && !isLost;
    place.replaceChildren(
      ...[
        quality &&
          h(
            "span",
            { class: "plan-bound" },
            icon(quality.isProven ? "circle-check" : "info", "small"),
            h("span", {}, h("strong", {}, quality.words), " ", quality.detail),
          ),
        separation &&
          h(
            "span",
            { class: `plan-bound${separation.isFault ? " fault" : ""}` },
            icon(separation.isFault ? "triangle-alert" : "replace", "small"),
            h("span", {}, separation.words),
          ),
        isLost &&
          h(
            "span",
            { class: "plan-bound fault" },
            icon("triangle-alert", "small"),
            h(
              "span",
              {},
              t("If the link is lost:"),
              " ",
              checkText(linkState, state.plan),
              h("button", { type: "button", class: "text-button", onclick: showLostLink }, t("Show")),
            ),
          ),
        locked > 0 && h("span", { class: "plan-wish" }, icon("lock", "small"), h("span", {}, wish), acts),
      ].filter(Boolean),
    );
  }

  function showLostLink() {
    const place = byId("lost-link");
    const scroll = place.closest(".side-scroll"); // alone: scrollIntoView would move what must not scroll
    scroll.scrollBy({ top: place.getBoundingClientRect().top - scroll.getBoundingClientRect().top });
    place.querySelector(".link-failures button")?.focus({ preventScroll: true });
  }

  function mark(state) {
    for (const element of list.children) {
      const sequence = Number(element.dataset.sequence);
      element.classList.toggle("lit", state.lookedAt === sequence);
      element.classList.toggle("chosen", state.chosenRoute === sequence);
      element.querySelector(".who").setAttribute("aria-pressed", String(state.chosenRoute === sequence));
    }
    for (const drawn of strips.values()) drawn.light(state.plan ? state.litTarget : null);
  }

  function follow(state) {
    const { along } = state;
    for (const [sequence, drawn] of strips)
      drawn.point(along?.sequence === sequence && !along.isWished ? along.at_m : null);
    const position = pointAlong(state);
    if (position || isPointed) showPoint(position);
    isPointed = position !== null;
  }

  /** Where routes go round zones, once the server has said so. */
  function lookForZones({ plan }) {
    for (const route of routesOf(plan)
      .filter(({ geometry }) => geometry)
      .slice(0, MOST_LOOKED_AT)) {
      if (zonesOf.has(route.waypoints)) continue;
      grounds(route).then(
        (ground) => {
          const { places } = profileOf(route.waypoints, route.length_m);
          zonesOf.set(route.waypoints, passedZones(ground, route, places, plan.result.departs_at ?? null));
          if (ground.zones.length && store.state.plan === plan) draw(store.state);
        },
        () => {}, // the strip stands without them; the profile says what failed
      );
    }
  }

  byId("compare-ways").addEventListener("click", () => {
    const isOpen = Boolean(store.state.why?.alternatives);
    store.update({ why: isOpen ? null : { alternatives: true } });
    if (!isOpen && canPlan) actions.planAlternatives();
  });
  byId("compare-plans").addEventListener("click", () =>
    store.update({ why: store.state.why?.compare ? null : { compare: true } }),
  );
  store.listen(["plan", "selection", "lastPlan", "mission"], draw);
  store.listen(["why"], (state) => {
    byId("compare-ways").setAttribute("aria-pressed", String(Boolean(state.why?.alternatives)));
    if (Boolean(state.why?.compare) !== dock.classList.contains("comparing")) draw(state);
  });
  store.listen(["plan"], (state) => {
    lookForZones(state);
    if (!state.planIsStored) dock.closest(".side-scroll")?.scrollTo({ top: 0 }); // on a phone the result of planning stands first
  });
  store.listen(["lookedAt", "chosenRoute", "litTarget"], mark);
  store.listen(["along"], follow);
  new ResizeObserver(() => {
    if (store.state.plan && stripRoom(dock) !== width_px) draw(store.state);
  }).observe(dock.querySelector(".dock-main"));
}
