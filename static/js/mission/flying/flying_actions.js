/**
 * What an operator does with a mission once it is planned: approve, send, steer, abort. Each asks first; the panels
 * listen to the store.
 */

import { ApiError, freshKey, get, post, signInAddress } from "../../api.js";
import { abortQuestion } from "../../domain/command_questions.js";
import { flyersOf, isFrozen, isOnItsWay, KINDS } from "../../domain/flying.js";
import { returnOf } from "../../domain/own_return.js";
import { confirmAct } from "../../page/confirm.js";
import { CHECKING_HOME, presentQuestion, returnsNow } from "../../page/present_returns.js";
import { tellUav } from "../../page/tell_uav.js";
import { say } from "../../page/toast.js";
import { t, tn } from "../../text.js";
import { heightText, lengthText } from "../../units.js";
import { createFlightReading } from "./flight_reading.js";

/** @import { Answer } from "../../api.js" */
/** @import { AskedKind } from "../../domain/command_questions.js" */
/** @import { CommandKind, Mission } from "../../api_types.d.ts" */
/** @import { Flyer } from "../../domain/flying.js" */
/** @import { MissionContext, MissionPageData, MissionPageState, MissionStore } from "../types.d.ts" */

/** @typedef {{ store: MissionStore, failed: MissionContext["failed"], readCommands: () => Promise<void> }} Acting */

/**
 * @param {MissionStore} store
 * @param {{ failed: MissionContext["failed"], page: Pick<MissionPageData, "isFrozen"> }} options
 */
export function createFlying(store, { failed, page }) {
  const { readCommands, readReturns, watch } = createFlightReading(store, page);
  const acting = { store, failed, readCommands };

  // What is approved is shown as to those who cannot change it, and the other way round: the page is made anew.
  store.listen(["mission"], ({ mission }) => {
    if (mission && isFrozen(mission) !== page.isFrozen) location.reload();
  });

  return {
    async approve() {
      await readReturns();
      await approve(acting);
    },
    revoke: () => revoke(acting),
    /**
     * flyer: one UAV's flight; without: all that have nothing yet.
     *
     * @param {Flyer | null} [flyer]
     * @param {number} [flight]
     */
    send: (flyer = null, flight = 1) => send(acting, flyer, flight),
    abort: () => abort(acting),
    /** @param {Flyer} flyer @param {AskedKind} kind */
    command: (flyer, kind) => command(acting, flyer, kind),
    /** To a height at which nothing is in its way home. @param {Flyer} flyer @param {number} height_m */
    setReturnHeight: (flyer, height_m) => tell(acting, flyer, "set-return-height", { height_m }),
    watch,
  };
}

/** The act is of the revision on the page, and done once. @param {MissionStore} store */
const asSeen = ({ state: { mission } }) => ({
  headers: { "If-Match": `"${mission?.revision}"`, "Idempotency-Key": freshKey() },
});
/** What stops UAVs is not held up by what somebody else has changed meanwhile. */
const whateverChanged = () => ({ headers: { "If-Match": "*", "Idempotency-Key": freshKey() } });
/** @param {Flyer[]} flyers */
const uavsWords = (flyers) => flyers.map(({ name }) => name).join(", ");

/** Warnings only, each once. @param {MissionPageState["returns"]} returns @param {Flyer[]} flyers */
function returnsOf(returns, flyers) {
  const lines = flyers.flatMap(({ place }) => {
    const check = returnOf(returns, place);
    if (!check) return [t("Its way home has not been checked: it flies straight, at a height of its own.")];
    return [...check.warnings, check.fence_warning].filter(Boolean);
  });
  return [...new Set(lines)];
}

/**
 * Tells what was refused, in the server's words.
 *
 * @param {Acting} acting
 * @param {string} title
 * @param {() => Promise<void>} act
 */
async function tried({ store, failed, readCommands }, title, act) {
  store.update({ isDispatching: true });
  try {
    await act();
    store.update({ problem: null });
  } catch (error) {
    if (!(error instanceof ApiError)) throw error;
    if (error.isSignedOut) failed(title, error, [{ label: t("Sign in"), href: signInAddress }]);
    else if (error.status === 412)
      failed(title, new ApiError(t("Somebody else has changed the mission. Look at it again."), { status: 412 }), [
        { label: t("Load again"), act: () => location.reload() },
      ]);
    else failed(title, error);
  } finally {
    store.update({ isDispatching: false });
    void readCommands();
  }
}

/** @param {MissionStore} store @param {string} id */
async function readMission(store, id) {
  const { data } = /** @type {Answer<Mission>} */ (await get(`/missions/${id}`));
  store.update({ mission: data });
}

/** @param {Acting} acting */
async function approve(acting) {
  const { store } = acting;
  const { mission } = store.state;
  if (!mission) return;
  const flyers = flyersOf(mission);
  const simulated = flyers.filter(({ place }) => mission.uavs[place].is_simulated);
  const asked = await confirmAct({
    title: t("Approve “{name}”?", { name: mission.name }),
    lines: [
      tn(flyers.length, "{count} UAV flies {length} in all: {names}.", "{count} UAVs fly {length} in all: {names}.", {
        length: lengthText(mission.plan?.total_length_m),
        names: uavsWords(flyers),
      }),
      simulated.length > 0 && t("Simulated, no real aircraft: {names}.", { names: uavsWords(simulated) }),
      t(
        "From then on nothing of the mission can be changed, and only what is approved is sent to UAVs. The approval can be revoked.",
      ),
      ...returnsOf(store.state.returns, flyers),
    ],
    field: {
      name: "longest_leg_m",
      label: t("Put points in on legs longer than [m]; empty: as planned"),
      type: "number",
      min: 50,
      max: 5000,
      step: "any",
    },
    act: t("Approve"),
    isBack: true,
    image: "badge-check",
  });
  if (!asked) return;
  const wishes = Number.isFinite(asked.longest_leg_m) ? asked : {};
  await tried(acting, t("Not approved."), async () => {
    const { data } = /** @type {Answer<Mission>} */ (
      await post(`/missions/${mission.id}/approve`, wishes, asSeen(store))
    );
    store.update({ mission: data });
  });
}

/** @param {Acting} acting */
async function revoke(acting) {
  const { store } = acting;
  const { mission } = store.state;
  if (!mission) return;
  const asked = await confirmAct({
    title: t("Revoke the approval of “{name}”?", { name: mission.name }),
    lines: isOnItsWay(mission)
      ? [
          t(
            "Every UAV that may have the mission is told to drop it. The approval ends once all of them were seen without it; then the mission can be changed again.",
          ),
          t("Until then it can be neither sent nor started."),
        ]
      : [t("The mission can be changed again, and has to be approved anew before it is sent.")],
    field: { name: "reason", label: t("Why (kept in the history)"), isNeeded: true },
    keep: t("Keep it approved"),
    act: t("Revoke"),
  });
  if (!asked) return;
  await tried(acting, t("Not revoked."), async () => {
    const { data } = /** @type {Answer<Mission>} */ (
      await post(`/missions/${mission.id}/revoke`, { reason: asked.reason }, asSeen(store))
    );
    store.update({ mission: data });
  });
}

/** @param {Acting} acting @param {Flyer | null} flyer @param {number} flight */
async function send(acting, flyer, flight) {
  const { mission } = acting.store.state;
  if (!mission) return;
  const flyers = flyer ? [flyer] : flyersOf(mission);
  const tooLow = flyers.flatMap(({ place, uav, name }) => {
    const height_m = returnOf(acting.store.state.returns, place)?.safe_height_m;
    return uav === null || typeof height_m !== "number" ? [] : [{ uav, name, height_m }];
  });
  const title = flyer
    ? flight > 1
      ? t("Send flight {flight} to {name}?", { flight, name: flyer.name })
      : t("Send its route to {name}?", { name: flyer.name })
    : tn(flyers.length, "Send the mission to {count} UAV?", "Send the mission to {count} UAVs?");
  const asked = await confirmAct({
    title,
    lines: [
      t(
        "{names}: what each one then has on board is read back and compared with what was approved. Nothing takes off by this.",
        { names: uavsWords(flyers) },
      ),
      t("A UAV that is not connected gets its route when it is, within the hour."),
      ...flyers.map(({ place }) => returnOf(acting.store.state.returns, place)?.fence_warning),
    ],
    checks: tooLow.map(({ uav, name, height_m }) => ({
      name: `height-${uav}`,
      words: t("Set the return height of {name} to {height} with it: lower, something is in its way home", {
        name,
        height: heightText(height_m),
      }),
    })),
    act: flyer ? t("Send to {name}", { name: flyer.name }) : t("Send to UAVs"),
    isBack: true,
    image: "send",
  });
  if (!asked) return;
  await tried(acting, t("Not sent."), async () => {
    const body = flyer ? { uav: flyer.place, flight } : {};
    await post(`/missions/${mission.id}/dispatch`, body, asSeen(acting.store));
    await readMission(acting.store, mission.id);
  });
  for (const { uav, name, height_m } of tooLow)
    if (asked[`height-${uav}`]) await tell(acting, { uav, name }, "set-return-height", { height_m });
}

/** @param {Acting} acting */
async function abort(acting) {
  const { mission } = acting.store.state;
  if (!mission) return;
  const flyers = flyersOf(mission);
  const told = { name: mission.name, isActive: mission.state === "active" };
  const first = abortQuestion({ ...told, uavs: flyers.map(({ name }) => ({ name, check: null })) });
  const later = returnsNow(flyers.flatMap(({ uav }) => uav ?? [])).then((returns) =>
    abortQuestion({ ...told, uavs: flyers.map(({ name, uav }) => ({ name, check: returns.get(uav ?? 0) })) }),
  );
  const asked = await confirmAct({ ...first, lines: [...first.lines.slice(0, 2), CHECKING_HOME], later });
  if (!asked) return;
  await tried(acting, t("Not aborted."), async () => {
    await post(`/missions/${mission.id}/abort`, { why: asked.why }, whateverChanged());
    await readMission(acting.store, mission.id);
  });
}

/** @param {Acting} acting @param {Flyer} flyer @param {AskedKind} kind */
async function command(acting, flyer, kind) {
  const planned = returnOf(acting.store.state.returns, flyer.place);
  const asked = await confirmAct(presentQuestion(flyer.uav, kind, { ...flyer, planned }));
  if (!asked) return;
  if (asked.safer) await tell(acting, flyer, asked.safer.kind, asked.safer.parameters);
  else await tell(acting, flyer, kind, asked);
}

/** @param {Acting} acting @param {Pick<Flyer, "uav" | "name">} flyer @param {CommandKind} kind @param {Record<string, any>} filled */
async function tell(acting, flyer, kind, filled) {
  const title = t("{name} was not told: {act}.", { name: flyer.name, act: KINDS[kind] });
  await tried(acting, title, async () => {
    if (await tellUav(flyer.uav, flyer.name, kind, filled)) {
      say(t("{act}: {name} is being told.", { act: KINDS[kind], name: flyer.name }));
    }
  });
}
