/** What can be done with the 3D view: cameras, UAVs, targets, time, a picture to keep and a link. Each says whether it was done. */

import { routeLetter } from "../domain/palette.js";
import { copyText } from "../page/clipboard.js";
import { toast } from "../page/toast.js";
import { t } from "../text.js";
import { dateText, exactClockText, sinceText } from "../units.js";
import { CAMERA_LONG } from "./camera_bar.js";
import { linkText } from "./link.js";
import { nextOf, targetToSee } from "./state.js";
import { download, fileName, stillOf } from "./still.js";

const WHOLE_M = 150; // round a flight of one place

/** See stage.js for what it is given; showBar(): cameras and UAVs have changed. */
export function createActs({
  stage,
  rig,
  hands,
  picture,
  player,
  hasOwnTime,
  targets,
  labels,
  atNow,
  frames,
  palette,
  onChange,
  onClose,
  step,
  showBar,
}) {
  const { source } = stage;
  const places = source.routes.map(({ place }) => place);

  function changed() {
    showBar();
    picture.request();
    onChange();
    return true;
  }

  function setCamera(mode) {
    if (stage.isFlat && mode !== "top") return false;
    rig.setMode(mode);
    return changed();
  }

  function choose(place) {
    if (!places.includes(place)) return false;
    stage.chosen = place;
    stage.target = null;
    rig.glide();
    return changed();
  }

  function seeTarget(place) {
    stage.target = place;
    if (rig.mode === "orbit") rig.glide();
    else if (!stage.isFlat) rig.setMode("orbit");
    return changed();
  }

  function timeWords() {
    if (!source.hasDate) return sinceText((atNow() - source.departs_ms) / 1_000);
    const iso = new Date(atNow()).toISOString();
    return `${dateText(iso)}, ${exactClockText(iso)}`;
  }

  function whatFlies() {
    const simulated = source.routes.filter(({ isSimulated }) => isSimulated);
    if (source.isSimulated) return t("Simulated");
    if (simulated.length)
      return t("Simulated, no real aircraft: {names}.", { names: simulated.map(({ name }) => name).join(", ") });
    return source.kind === "plan" ? t("Planned, not flown") : "Spanwise";
  }

  function link() {
    const state = rig.state();
    const place = state.mode === "free" ? picture.frame.toGeographic(state.eye) : null;
    const time =
      source.kind === "live"
        ? {}
        : source.hasDate
          ? { at_ms: Math.round(atNow()) }
          : { since_s: (atNow() - source.departs_ms) / 1_000 };
    return linkText({
      source: { kind: source.kind, rehearsal: source.rehearsal ?? null, run: source.run ?? null },
      ...time,
      uav: stage.chosen,
      target: stage.target,
      camera: { ...state, place },
    });
  }

  const acts = {
    setCamera,
    choose,
    seeTarget,
    link,
    chooseNumber: (number) => (source.routes[number] ? choose(source.routes[number].place) : false),
    next: (by) => choose(nextOf(places, stage.chosen, by)),
    nextTarget(by) {
      const order = targets.map(({ place }) => place);
      if (!order.length) return false;
      const seen =
        stage.target ??
        targetToSee(
          source,
          null,
          frames()
            ?.drawn()
            .find(({ route }) => route === stage.chosen)?.task,
          stage.chosen,
        )?.place;
      return seeTarget(rig.mode === "orbit" ? nextOf(order, seen, by) : seen);
    },
    zoom(factor) {
      rig.zoom(factor);
      return changed();
    },
    /** All that was planned, in the picture. */
    fit() {
      const [xs, zs] = [0, 2].map((axis) =>
        targets
          .map(({ place3d }) => place3d[axis])
          .concat(
            frames()
              .drawn()
              .map(({ place }) => place[axis]),
          ),
      );
      if (!xs.length) return false;
      const middle = [xs, zs].map((values) => (Math.min(...values) + Math.max(...values)) / 2);
      const radius_m = Math.max(WHOLE_M, ...xs.map((x, index) => Math.hypot(x - middle[0], zs[index] - middle[1])));
      if (rig.mode !== "top" && !stage.isFlat) rig.setMode("orbit");
      rig.fit(radius_m);
      const subject = frames()
        .drawn()
        .find(({ route }) => route === stage.chosen);
      const target = targetToSee(source, stage.target, subject?.task, stage.chosen);
      const from =
        rig.mode === "top"
          ? (subject?.place ?? [0, 0, 0])
          : (targets.find(({ place }) => place === target?.place)?.place3d ?? subject?.place ?? [0, 0, 0]);
      rig.offset = [middle[0] - from[0], 0, middle[1] - from[2]];
      return changed();
    },
    press: (event) => hands.press(event),
    toggle() {
      if (!player || !hasOwnTime) return false;
      player.toggle();
      return true;
    },
    step: (direction) => (step(direction), Boolean(player)),
    changeSpeed: (direction) => (player?.changeSpeed(direction), Boolean(player)),
    async keepPicture() {
      const uav = source.routes.find(({ place }) => place === stage.chosen);
      const words = [
        stage.mission.name,
        [timeWords(), uav && `${routeLetter(uav.place)} ${uav.name}`, CAMERA_LONG[rig.mode]]
          .filter(Boolean)
          .join(" · "),
        whatFlies(),
      ];
      const at = source.hasDate
        ? new Date(atNow()).toISOString().slice(0, 19).replaceAll(":", "").replace("T", "-")
        : `${Math.round((atNow() - source.departs_ms) / 1_000)}s`;
      await download(
        stillOf(picture.copy(), labels.shown(), words, palette()),
        fileName(stage.mission.name, at, rig.mode),
      );
    },
    async copyLink() {
      await copyText(new URL(acts.address(), location.href).href);
      toast(t("The link to this moment is copied."));
    },
    address: () => `/missions/${stage.mission.id}/3d${link()}`,
    close: () => onClose(),
    /** As a link says, else the first UAV from behind. */
    begin(wanted) {
      stage.chosen = places.includes(wanted?.uav) ? wanted.uav : (places[0] ?? null);
      stage.target = targets.some(({ place }) => place === wanted?.target) ? wanted.target : null;
      const { camera = null, at_ms = null, since_s = null } = wanted ?? {};
      if (camera) {
        const eye = camera.place && picture.frame.toLocal(...camera.place);
        rig.restore({
          ...camera,
          mode: stage.isFlat ? "top" : camera.mode,
          eye,
          offset: camera.offset,
          view: stage.isFlat && camera.mode !== "top" ? null : camera.view,
        });
      } else if (stage.isFlat) rig.restore({ mode: "top" });
      if (player && hasOwnTime && (at_ms !== null || since_s !== null))
        player.seek(at_ms ?? source.departs_ms + since_s * 1_000);
      showBar();
    },
  };
  return acts;
}
