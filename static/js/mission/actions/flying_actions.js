/** What an operator does with a mission once it is planned: approve, send, steer, abort. Each asks first; the panels listen to the store. */

import { ApiError, get, post, signInAddress } from "../../api.js";
import { LATE, questionOf, WHY } from "../../domain/command_questions.js";
import { flyersOf, isFrozen, isOnItsWay, isOpen, KINDS } from "../../domain/flying.js";
import { returnLines, returnOf } from "../../domain/own_return.js";
import { confirmAct } from "../../page/confirm.js";
import { say, toast } from "../../page/toast.js";
import { t, tn } from "../../text.js";
import { lengthText } from "../../units.js";

const POLL_MS = 2000;
const CONNECTIONS_EVERY_MS = 20_000;
const RETURNS_EVERY_MS = 60_000; // they take the server longer, and seldom change

/** failed: see actions.js. store.commands: of the mission, the newest first, null until they are read. */
export function createFlying(store, { failed, page }) {
  let timer = 0;
  let isAsking = false;
  let connectionsAt = 0;
  let returnsAt = 0;

  const mission = () => store.state.mission;
  const ifMatch = () => ({
    headers: {
      "If-Match": `"${mission().revision}"`,
      "Idempotency-Key": crypto.randomUUID?.() ?? `${Date.now()}-${Math.random()}`,
    },
  });
  const uavsWords = (flyers) => flyers.map(({ name }) => name).join(", ");

  /** Tells what was refused, in the server's words. */
  async function tried(title, act) {
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

  async function readMission() {
    const { data } = await get(`/missions/${mission().id}`);
    store.update({ mission: data });
  }

  /** store.connections: by UAV, what is known of it and of what is on board; null while that could not be read. */
  async function readConnections() {
    connectionsAt = Date.now();
    const uavs = flyersOf(mission())
      .map(({ uav }) => uav)
      .filter((uav) => uav !== null);
    const read = await Promise.all(
      uavs.map((uav) =>
        get(`/uavs/${uav}/connection`).then(
          ({ data }) => [uav, data],
          () => [uav, null],
        ),
      ),
    );
    store.update({ connections: new Map(read) });
  }

  /** store.returns: what is in the way home, as it was last looked at; null until then. */
  async function readReturns() {
    if (!mission()) return;
    returnsAt = Date.now();
    try {
      store.update({ returns: (await get(`/missions/${mission().id}/returns`)).data.results });
    } catch (error) {
      if (!(error instanceof ApiError)) throw error;
      store.update({ returns: null });
    }
  }

  /** Warnings only, each once. */
  const returnsOf = (flyers) => [
    ...new Set(
      flyers.flatMap(({ place }) => {
        const check = returnOf(store.state.returns, place);
        return check ? check.warnings : returnLines(check);
      }),
    ),
  ];

  async function approve() {
    const flyers = flyersOf(mission());
    const simulated = flyers.filter(({ place }) => mission().uavs[place].is_simulated);
    await readReturns();
    const asked = await confirmAct({
      title: t("Approve “{name}”?", { name: mission().name }),
      lines: [
        tn(flyers.length, "{count} UAV flies {length} in all: {names}.", "{count} UAVs fly {length} in all: {names}.", {
          length: lengthText(mission().plan.total_length_m),
          names: uavsWords(flyers),
        }),
        simulated.length > 0 && t("Simulated, no real aircraft: {names}.", { names: uavsWords(simulated) }),
        t(
          "From then on nothing of the mission can be changed, and only what is approved is sent to UAVs. The approval can be revoked.",
        ),
        ...returnsOf(flyers),
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
    await tried(t("Not approved."), async () =>
      store.update({ mission: (await post(`/missions/${mission().id}/approve`, wishes, ifMatch())).data }),
    );
  }

  async function revoke() {
    const away = isOnItsWay(mission());
    const asked = await confirmAct({
      title: t("Revoke the approval of “{name}”?", { name: mission().name }),
      lines: away
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
    if (asked)
      await tried(t("Not revoked."), async () =>
        store.update({
          mission: (await post(`/missions/${mission().id}/revoke`, { reason: asked.reason }, ifMatch())).data,
        }),
      );
  }

  /** flyer: one UAV's flight; without: all that have nothing yet. */
  async function send(flyer = null, flight = 1) {
    const flyers = flyer ? [flyer] : flyersOf(mission());
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
      ],
      act: flyer ? t("Send to {name}", { name: flyer.name }) : t("Send to UAVs"),
      isBack: true,
      image: "send",
    });
    if (!asked) return;
    await tried(t("Not sent."), async () => {
      await post(`/missions/${mission().id}/dispatch`, flyer ? { uav: flyer.place, flight } : {}, ifMatch());
      await readMission();
    });
  }

  async function abort() {
    const flyers = flyersOf(mission());
    const asked = await confirmAct({
      title: t("Abort “{name}”?", { name: mission().name }),
      lines: [
        t(
          "{names} are told before anything else that is waiting. Targets that are not reached stay undone, and the mission cannot be taken up again.",
          { names: uavsWords(flyers) },
        ),
        ...returnsOf(flyers),
        LATE,
      ],
      field: WHY,
      keep: mission().state === "active" ? t("Keep flying") : t("Keep it"),
      act: t("Abort the mission"),
      isDanger: true,
      image: "octagon-alert",
    });
    if (!asked) return;
    await tried(t("Not aborted."), async () => {
      await post(`/missions/${mission().id}/abort`, { why: asked.why }, ifMatch());
      await readMission();
    });
  }

  async function command(flyer, kind) {
    const asked = await confirmAct(questionOf(kind, { ...flyer, returns: returnOf(store.state.returns, flyer.place) }));
    if (!asked) return;
    const { why = "", ...parameters } = asked;
    await tried(t("{name} was not told: {act}.", { name: flyer.name, act: KINDS[kind] }), async () => {
      await post(
        `/uavs/${flyer.uav}/commands`,
        { kind, why, parameters },
        { headers: { "Idempotency-Key": ifMatch().headers["Idempotency-Key"] } },
      );
      say(t("{act}: {name} is being told.", { act: KINDS[kind], name: flyer.name }));
    });
  }

  // what became of it

  async function readCommands() {
    if (isAsking || !mission()) return;
    isAsking = true;
    try {
      const { data } = await get(`/missions/${mission().id}/commands?limit=200`);
      tellChanges(store.state.commands, data.results);
      store.update({ commands: data.results });
    } catch (error) {
      if (!(error instanceof ApiError)) throw error; // else watchMission says that the server is away
    } finally {
      isAsking = false;
    }
  }

  /** Said once to whoever listens: what was carried out, and what was not. */
  function tellChanges(before, now) {
    if (!before) return;
    const states = new Map(before.map(({ id, state }) => [id, state]));
    for (const { id, uav, kind, state, outcome } of now) {
      if (isOpen({ state }) || !states.has(id) || states.get(id) === state) continue;
      void readConnections();
      const words = { name: uav.name, act: KINDS[kind], outcome };
      if (state === "applied") say(t("{act}: {name} has done it.", words));
      else if (state === "failed") toast(t("{act}: {name} has not done it. {outcome}", words));
    }
  }

  /** While the page is looked at: often while something is under way, else now and then. */
  function watch() {
    clearInterval(timer);
    if (!page.isFrozen) return;
    timer = setInterval(() => {
      const { commands } = store.state;
      const isBusy = mission() && (isOnItsWay(mission()) || commands?.some(isOpen));
      if (document.hidden || !isBusy) return;
      void readCommands();
      if (Date.now() - connectionsAt >= CONNECTIONS_EVERY_MS) void readConnections();
      if (Date.now() - returnsAt >= RETURNS_EVERY_MS) void readReturns();
    }, POLL_MS);
    store.listen(["mission"], ({ mission: now }) => {
      if (!now || store.state.commands !== null) return;
      void readCommands();
      void readConnections();
      void readReturns();
    });
    document.addEventListener("visibilitychange", () => !document.hidden && void readCommands());
  }

  /** What is approved is shown as to those who cannot change it, and the other way round: the page is made anew. */
  store.listen(["mission"], ({ mission: now }) => {
    if (now && isFrozen(now) !== page.isFrozen) location.reload();
  });

  return { approve, revoke, send, abort, command, watch };
}
