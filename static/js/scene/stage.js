/** The 3D view of one mission in an element: picture, labels, instruments, cameras and time, for a page of its own and for panels. */

import { get, signInAddress } from "../api.js";
import { h, icon } from "../dom.js";
import { routeLetter } from "../domain/palette.js";
import { onTheme } from "../page/theme.js";
import { createPlayer } from "../record/player.js";
import { simulatedMark } from "../simulated.js";
import { t } from "../text.js";
import { createActs } from "./acts.js";
import { createCameraBar } from "./camera_bar.js";
import { listenToHands } from "./cameras/hands.js";
import { createRig } from "./cameras/rig.js";
import { createFlatPicture } from "./flat/flat_picture.js";
import { drawFlight } from "./flight/drawn_flight.js";
import { createFrames } from "./frames.js";
import { surroundingsOf } from "./instruments/distances.js";
import { createInstruments } from "./instruments/panel.js";
import { createLabels } from "./labels.js";
import { readScenePalette } from "./palette.js";
import { createPicture } from "./picture.js";
import { boxRound, placesOf } from "./sources/box.js";
import { createTimeBar } from "./time_bar.js";
import { NoWebGL } from "./view.js";

const calm = matchMedia("(prefers-reduced-motion: reduce)");
const USUAL_SPEED = 5;

const NO_WEBGL = () => ({
  title: t("This browser draws no 3D."),
  words: t("WebGL is missing or switched off. You see the flight from above instead."),
});

/** How the flight is seen: in space, or from above where there is no WebGL. */
function pictureIn(holder, options) {
  const canvas = () => h("canvas", { class: "scene-canvas", tabindex: 0, role: "img" });
  const first = canvas();
  holder.append(first);
  try {
    return { canvas: first, picture: createPicture(holder, first, options) };
  } catch (error) {
    if (!(error instanceof NoWebGL)) throw error;
    const second = canvas(); // one that was asked for WebGL gives nothing else
    first.replaceWith(second);
    return { canvas: second, picture: createFlatPicture(holder, second, options) };
  }
}

/**
 * root: an element with a size. mission: { id, name }; source: of sources/read.js; link: of link.js or null. isPanel: with a button that closes it.
 * player: of the page that it stands on, or null: then it has its own where the source has a span. now_ms(): of a live source.
 * onChange(): what a link would say is another. onClose(). isWanted(): whether it still is once the ground is read; else null is given.
 * → acts and point(); throws ApiError.
 */
export async function openStage(
  root,
  {
    mission,
    source,
    link = null,
    isPanel = false,
    player: hostPlayer = null,
    now_ms = () => Date.now(),
    onChange = () => {},
    onClose = () => {},
    openAddress = () => "",
    isWanted = () => true,
  },
) {
  const scene = await readScene(source);
  if (!isWanted()) return null;
  let palette = readScenePalette();
  const holder = h("div", { class: "scene-picture" });
  const notice = h("p", { class: "scene-notice float", role: "status", hidden: true });
  const stale = h("p", { class: "scene-notice float warning", role: "status", hidden: true });
  const stage = { mission, source, chosen: null, target: null, isFlat: false, isPanel, now_ms };
  let frames = null;
  root.replaceChildren(holder);

  const made = pictureIn(holder, {
    palette,
    draw: (time) => frames?.draw(time) ?? false,
    onLost: () => tell(t("The graphics have stopped."), t("They are started again as soon as the browser can.")),
    onFound: () => (notice.hidden = true),
  });
  const { canvas, picture } = made;
  stage.isFlat = picture.kind === "2d";
  const rig = createRig({ isCalm: () => calm.matches });
  const labels = createLabels(holder);
  const instruments = createInstruments();
  holder.append(h("div", { class: "scene-notices" }, notice, stale));

  picture.showGround(scene);
  const flight = drawFlight(source, {
    frame: picture.frame,
    groundAt: picture.groundAt,
    groundKind: scene.ground.kind,
  });
  picture.showFlight(flight, source.routes.length, source.span?.from_ms ?? 0);
  const heights = new Map(scene.supports.map(({ id, likely_m }) => [id, likely_m]));
  const targets = source.targets.map((target) => ({
    ...target,
    place3d: flight.targetPlace({ position: target.position, height_m: heights.get(target.asset) ?? null }),
  }));

  let lastMove_ms = null;
  const player = hostPlayer ?? (source.span ? createPlayer({ onMove: () => (moved(), bar?.show()) }) : null);
  if (!hostPlayer && player) {
    player.speed = USUAL_SPEED;
    player.setSpan(source.span);
  }
  function moved() {
    const far = lastMove_ms !== null && Math.abs(player.at_ms - lastMove_ms) > 5_000 * Math.max(1, player.speed / 20);
    if (far) rig.settle(); // a jump in time is one in space
    lastMove_ms = player.at_ms;
    picture.request();
    if (!player.isPlaying) onChange();
  }

  const hands = listenToHands(canvas, rig, {
    onChange: () => (picture.request(), onChange()),
    onPick: (at) => frames.pick(at),
  });
  const atNow = () => (player ? player.at_ms : now_ms());
  const acts = createActs({
    stage,
    rig,
    hands,
    picture,
    player,
    hasOwnTime: !hostPlayer,
    targets,
    labels,
    atNow,
    frames: () => frames,
    palette: () => palette,
    onChange,
    onClose,
    step: (direction) => bar?.step(direction),
    showBar: () => cameraBar.show({ mode: rig.mode, chosen: stage.chosen, isFlat: stage.isFlat }),
  });
  const cameraBar = createCameraBar({ routes: source.routes, acts, isPanel, openAddress });
  const bar =
    !hostPlayer && player ? createTimeBar({ player, source, eventWords: (event) => eventWords(event, source) }) : null;
  frames = createFrames({
    stage,
    scene,
    picture,
    canvas,
    rig,
    hands,
    player,
    flight,
    targets,
    labels,
    instruments,
    palette: () => palette,
    atNow,
    isCalm: () => calm.matches,
    surroundings: surroundingsOf(scene, picture.frame, picture.wires(), picture.groundAt),
    overlays: () => [...cameraBar.element.children, ...chips.children, instruments.element, notice, stale],
    choose: acts.choose,
    seeTarget: acts.seeTarget,
  });

  const chips = h(
    "div",
    { class: "scene-chips" },
    source.isSimulated && simulatedMark(),
    source.kind === "plan" && h("span", { class: "chip draft" }, t("Planned, not flown")),
    source.kind === "live" && h("span", { class: "chip active" }, t("Live")),
    scene.ground.kind === "flat" && h("span", { class: "chip draft" }, t("Flat ground assumed")),
  );
  holder.append(h("div", { class: "scene-over" }, cameraBar.element, chips), instruments.element);
  if (bar) root.append(bar.element);
  if (stage.isFlat) {
    const { title, words } = NO_WEBGL();
    tell(title, words);
  }
  if (bar)
    new ResizeObserver(() => root.style.setProperty("--scene-time", `${bar.element.offsetHeight}px`)).observe(
      bar.element,
    );

  function tell(title, words) {
    notice.hidden = false;
    notice.replaceChildren(icon("info"), h("span", {}, h("strong", {}, title), ` ${words}`));
  }

  const endTheme = onTheme(() => {
    palette = readScenePalette();
    picture.setPalette(palette);
  });
  const onCalm = () => picture.request();
  calm.addEventListener("change", onCalm);

  acts.begin(link, { scene });
  bar?.show();
  picture.request();

  return {
    ...acts,
    source,
    kind: picture.kind,
    /** For measurements: of view.js, and how many towers stand within the picture. */
    figures: () => (picture.figures ? { ...picture.figures(), towers: towersIn(picture, scene) } : null),
    request: picture.request,
    /** For a page with a time of its own: it has moved, or another UAV is looked at. */
    point(place) {
      if (place !== null && place !== stage.chosen) acts.choose(place);
      moved();
    },
    /** What staleWords of live/stale.js says of a live source. */
    sayStale(said) {
      const words = [said?.words, said?.rest].filter(Boolean).join(" ");
      if (stale.dataset.words === words) return;
      stale.dataset.words = words;
      stale.hidden = !said;
      if (said)
        stale.replaceChildren(
          icon("cloud-off"),
          h(
            "span",
            {},
            h("strong", {}, said.words),
            said.rest && ` ${said.rest}`,
            said.needsDoor && [" ", h("a", { href: signInAddress() }, t("Sign in"))],
          ),
        );
    },
    /** A record has grown: of report/load.js. */
    renew(loaded) {
      source.renew(loaded);
      picture.showFlown(flight, source.span?.from_ms ?? 0);
      if (bar) player.setSpan(source.span);
      bar?.renew();
      picture.request();
    },
    /** A live source has grown or moved. */
    refresh(hasGrown) {
      if (hasGrown) picture.showFlown(flight, source.routes[0]?.pieces[0]?.samples[0]?.at_ms ?? 0);
      picture.request();
    },
    dispose() {
      if (!hostPlayer) player?.stop();
      endTheme?.();
      calm.removeEventListener("change", onCalm);
      hands.dispose();
      picture.dispose();
      root.replaceChildren();
    },
  };
}

function towersIn({ project, size, frame }, { supports }) {
  return supports.filter(({ kind, position, ground_amsl_m, height_m }) => {
    const at =
      kind === "vertex" ? null : project(frame.toLocal(position[0], position[1], ground_amsl_m + height_m / 2));
    return at && at.x >= 0 && at.y >= 0 && at.x <= size.width && at.y <= size.height;
  }).length;
}

async function readScene(source) {
  const box = boxRound(placesOf(source));
  return (await get(`/scene?bbox=${(box ?? [0, 0, 0.01, 0.01]).join(",")}`)).data;
}

function eventWords({ kind, place, target, alert }, source) {
  const name = source.routes.find((route) => route.place === place)?.name ?? "";
  const words = {
    "take-off": () => t("{name} takes off", { name }),
    landing: () => t("{name} lands", { name }),
    target: () =>
      t("{target} reached", { target: source.targets.find((one) => one.place === target)?.label ?? target + 1 }),
    alert: () => [name, alert.message].filter(Boolean).join(": "),
  };
  return words[kind]();
}

/** "A Wigeon": how a route is called. */
export const routeName = ({ place, name }) => `${routeLetter(place)} ${name}`;
