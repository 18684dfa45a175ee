/** Commands to the chosen UAV, and to all that fly. Each asks first; nothing is done by one key or click. */

import { get, post } from "../api.js";
import { byId, h, icon } from "../dom.js";
import { routeLetter, routeNumber } from "../map/palette.js";
import { ASKED } from "../mission/command_questions.js";
import { commandWords, KINDS } from "../mission/flying.js";
import { returnOf } from "../mission/own_return.js";
import { confirmAct } from "../mission/panels/confirm.js";
import { say, toast } from "../page/toast.js";
import { t, tn } from "../text.js";

const BUTTONS = [["pause", "pause"], ["resume", "play"], ["hold", "hand"], ["return", "rotate-ccw"], ["land", "plane-landing"], ["change-speed", "gauge"], ["abort", "octagon-alert"]];
const USUAL_SPEED_MPS = 8;

const once = () => ({ headers: { "Idempotency-Key": crypto.randomUUID?.() ?? `${Date.now()}-${Math.random()}` } });

/** chosen() → { uav, view, route } or null; flying() → all that are in the air, the same way. */
export function mountCommands({ chosen, flying }) {
  const bar = byId("command-bar");
  let shown = "";

  async function give({ uav }, kind, { why = "", ...parameters } = {}) {
    try {
      await post(`/uavs/${uav.id}/commands`, { kind, why, parameters }, once());
      say(t("{act}: {name} is being told.", { act: KINDS[kind], name: uav.name }));
      return true;
    } catch (error) {
      toast(t("{name} was not told: {act}. {reason}", { name: uav.name, act: KINDS[kind], reason: error.message }));
      return false;
    }
  }

  async function returnsOf(uav) {
    if (!uav.mission) return undefined;
    const found = await get(`/missions/${uav.mission}/returns`).then(({ data }) => data.results, () => null);
    return returnOf(found, uav.place);
  }

  const late = ({ view }) => view.isLate && t("The link is lost. The command waits and is sent on contact, until it expires.");

  async function ask(kind) {
    const one = chosen();
    if (!one) return false;
    const returns = kind === "return" || kind === "abort" ? await returnsOf(one.uav) : undefined;
    const speed_mps = one.view.speed_mps > 1 ? one.view.speed_mps : USUAL_SPEED_MPS;
    const question = ASKED[kind]({ name: one.uav.name, route: one.route, returns, speed_mps });
    const asked = await confirmAct({ ...question, lines: [...question.lines, late(one)] });
    if (asked) await give(one, kind, asked);
    return true;
  }

  async function askAll(kind) {
    const all = flying();
    if (!all.length) return toast(t("No UAV is in the air."));
    const names = all.map(({ uav }) => uav.name).join(", ");
    const isPause = kind === "pause";
    const asked = await confirmAct({
      title: isPause ? tn(all.length, "Pause {count} UAV?", "Pause {count} UAVs?") : tn(all.length, "Return {count} UAV?", "Return {count} UAVs?"),
      lines: [isPause ? t("{names}: each stops on its route and waits for Resume, as long as its battery lasts.", { names }) : t("{names}: each flies back by itself to where it took off and lands there. Targets that are not reached stay undone.", { names }), all.some(({ view }) => view.isLate) && t("One that is not heard at present is told on contact, until the command expires.")],
      keep: t("Keep flying"), act: isPause ? t("Pause all") : t("Return all"), isBack: true, image: isPause ? "pause" : "rotate-ccw",
    });
    if (asked) await Promise.all(all.map((one) => give(one, kind)));
    return undefined;
  }
  byId("pause-all").addEventListener("click", () => void askAll("pause"));
  byId("return-all").addEventListener("click", () => void askAll("return"));

  return {
    ask,
    draw() {
      const one = chosen();
      byId("live-foot").hidden = flying().length === 0;
      bar.hidden = !one?.uav.mission;
      const key = bar.hidden ? "" : `${one.uav.id} ${one.uav.name} ${one.uav.place}`;
      if (key === shown) return;
      shown = key;
      if (bar.hidden) return;
      bar.className = `command-bar float route-${routeNumber(one.uav.place ?? 0)}`;
      bar.setAttribute("aria-label", t("Commands to {name}", { name: one.uav.name }));
      bar.replaceChildren(
        h("span", { class: "command-whom" }, one.uav.place !== null && h("span", { class: "letter" }, routeLetter(one.uav.place)), h("strong", {}, one.uav.name)),
        ...BUTTONS.map(([kind, image]) => h("button", { type: "button", class: `bar-button${kind === "abort" ? " danger" : ""}`, onclick: () => void ask(kind) }, icon(image, "small"), h("span", {}, KINDS[kind]))),
      );
    },
  };
}

/** What is being done by a UAV's newest command, for a few seconds after its end: { words, image, level } or null. */
export function commandSaid(commands, uav, now_ms) {
  const own = commands.filter((command) => command.uav.id === uav.id).sort((a, b) => Date.parse(b.created_at) - Date.parse(a.created_at))[0];
  if (!own || (own.finished_at && now_ms - Date.parse(own.finished_at) > 60_000)) return null;
  return commandWords(own);
}
