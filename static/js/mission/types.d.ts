/** State of a mission's page and the shapes that its modules share. Positions are longitude, latitude [deg]. */

import type {
  Camera,
  Command,
  ConditionsOutput,
  Ground,
  HandLook,
  LastPlan,
  LastRoute,
  LostLinkOutput,
  Mission,
  MissionUav,
  ObjectiveEnum,
  PickedAsset,
  Plan,
  Preflight,
  Present,
  Rehearsal,
  RehearsalDetail,
  RehearsalTrack,
  ReturnCheck,
  Route,
  TargetInputRequest,
  TargetPriority,
  TaskKind,
  UavConnection,
  UavFigure,
  UavState,
  ViewPattern,
} from "../api_types.d.ts";
import type { RasterMap } from "../map/types.d.ts";
import type { createHistory, Store } from "../store.js";
import type { OwnFigure } from "../uav_figures.js";
import type { createDrafts } from "./actions/draft.js";
import type { createRunningJob } from "./actions/running_job.js";

/** What the server writes into the page (missions/pages.py). */
export interface MissionPageData {
  userId: number;
  userName: string;
  canPlan: boolean;
  canFly: boolean;
  canCurate: boolean;
  isFrozen: boolean;
  /** "plan", "rehearse" or "fly" */
  stage: string;
  /** id of a stored mission */
  mission: string | null;
  extent: [number, number, number, number] | null;
  bounds: [number, number, number, number] | null;
  baseMap: RasterMap;
  satellite: RasterMap;
}

// what is picked

/** A task as it is chosen; without seconds its kind's own count. */
export interface Task {
  kind: TaskKind;
  hold_s?: number | null;
  /** planned photos; null: none */
  views?: Views | null;
  /** along a line, at most; null: as the UAV flies */
  speed_mps?: number | null;
}

/** Photos of a target: of every part, an overview or its wires, with which camera, how fine, and how low the UAV may come. */
export interface Views {
  pattern?: ViewPattern;
  gsd_mm: number;
  min_height_m: number;
  camera: Camera;
}

/** How urgent a target is, which UAV alone may fly it, which sensor it needs. */
export interface Wishes {
  priority: TargetPriority;
  uav: string | null;
  sensor: string;
}

/** A target that is picked. The same place has the same key. */
export interface PickedTarget extends Partial<Wishes>, Pick<TargetInputRequest, "external_id" | "attributes"> {
  key: string;
  /** id; null for a place on the map */
  asset: number | null;
  kind: string;
  label: string;
  detail: string;
  /** id of the line that a support carries */
  line?: number | null;
  /** of a line, railway or part that was picked on this page */
  length_m?: number | null;
  /** one point of a line or railway, or the place itself */
  position: number[] | null;
  /** ends of a part of a line */
  stretch: number[][] | null;
  centre: number[] | null;
  task: Task | null;
}

/** An asset that can be picked: of a tile of the map, or of an answer. */
export interface PickableAsset {
  id: number;
  kind: string;
  properties: { label: string; detail?: string; length_m?: number | null; line?: number | null };
  centre?: number[] | null;
  position?: number[] | null;
  stretch?: number[][] | null;
  task?: Task | null;
}

/** A mission's own values of a UAV; omitted ones are as in the fleet. null: it has none. */
export type UavValues = {
  [Name in
    | "max_range_m"
    | "cruise_speed_mps"
    | "most_targets"
    | "battery_wh"
    | "mass_kg"
    | "reserve_percent"
    | "max_airspeed_mps"
    | "rotor_disk_m2"
    | "hover_power_w"]?: number | null;
} & { end_action?: MissionUav["end_action"]; sorties?: number; sensors?: string[]; own_figures?: UavFigure[] };

/** What the fleet knows of a UAV as it is now. */
export interface FleetFacts {
  base: number | null;
  base_name: string;
  state: UavState;
  /** what must be stated before it can be planned */
  missing: string[];
  type_name: string;
  battery_percent: number | null;
  heading_deg: number | null;
  is_simulated: boolean;
  /** its own figures, which a mission may change */
  usual: Record<OwnFigure, number | null>;
}

/** A UAV of a mission: of the fleet, of the stored mission, or of a draft. */
export interface PickedUav extends UavValues, Partial<FleetFacts> {
  id: number | null;
  name: string;
  position: number[];
}

/** A UAV of the fleet: see uavOf. */
export type FleetUav = PickedUav & FleetFacts & { id: number; sensors: string[] };

/** A UAV with its place in the mission; null: it does not fly. */
export interface StandingUav extends PickedUav {
  sequence: number | null;
  letter: string;
  isGone?: boolean;
}

/** A run of targets that one UAV flies in this order. `targets` are keys. */
export interface Lock {
  uav: string;
  targets: string[];
  at_start: boolean;
  at_end: boolean;
}

/** Keys of the targets that a UAV flies, in order. */
export interface FlownOrder {
  uav: string;
  targets: string[];
}

export type Conditions = ConditionsOutput;
export type LostLink = LostLinkOutput;

/** When and in what air a mission is flown; null is any time, calm, no charging, and going on without a link. */
export interface FlightOptions {
  departs_at: string | null;
  conditions: Conditions | null;
  charging_w: number | null;
  lost_link: LostLink | null;
}

/** What is to be flown: see selection.js. */
export interface MissionSelection extends FlightOptions {
  targets: PickedTarget[];
  uavs: PickedUav[];
  objective: ObjectiveEnum;
  return_to_start: boolean;
  locks: Lock[];
}

/** One of two versions of a mission that are compared or merged. */
export interface Version {
  name: string;
  selection: MissionSelection;
}

/** What the browser keeps of an unsaved mission. `base` is what the changes were made from. */
export interface Draft extends Version {
  editor: string;
  kept_at: string;
  revision: number;
  base?: Version | null;
  /** of a mission that is not stored: the plan that was shown, and the one before */
  plans?: { shown: ShortPlan | null; last: ShortPlan | null };
}

// what is planned

/** A plan of the server; a large one names the job that has made it. */
export type PlanResult = Plan & { job?: string };

/** A plan on the page with what it was made for: its indices point into `targets` and `uavs`. */
export interface ShownPlan extends Pick<MissionSelection, "targets" | "uavs" | "charging_w"> {
  result: PlanResult;
  /** of the selection: see basisOf */
  basis: string;
  /** the same without locks and wishes */
  freeBasis: string;
}

/** A route of the plan with its place in the mission. */
export interface ShownRoute extends Route {
  sequence: number;
  letter: string;
  name: string;
  /** it is changed by hand, and shown as it would be flown */
  isWished?: boolean;
}

/** A route of a plan in short; `stops` and `start` may be unknown of an old one. */
export type ShortRoute = Omit<LastRoute, "start"> & { start?: number[] | null };

/** A plan in short: the one before on this page, or the one that the mission remembers. */
export type ShortPlan = Pick<
  LastPlan,
  "objective" | "return_to_start" | "total_length_m" | "duration_s" | "unassigned"
> & { planned_at: string | null; routes: ShortRoute[] };

/** The best plan of a search so far (missions/services/best_so_far.py). */
export interface BestSoFar {
  unit: "m" | "s" | "Wh";
  value: number;
  bound: number | null;
  left_out: number;
  routes: {
    type: "FeatureCollection";
    features: {
      type: "Feature";
      properties: { uav: number; targets: number };
      geometry: { type: "LineString"; coordinates: number[][] };
    }[];
  };
}

/** What is being planned. */
export interface Planning {
  what: string;
  /** 0 to 1; null: not known */
  share: number | null;
  job: string | null;
  best: BestSoFar | null;
  isStopping: boolean;
  found?: string;
  isQueued?: boolean;
}

// notices of the page

/** A way out of a problem: an act, or an address. */
export type WayOut = { label: string; act?: () => unknown; href?: () => string };

export interface Problem {
  title: string;
  text: string;
  actions: WayOut[];
  level: "critical" | "warning";
  isOfSaving: boolean;
  /** the selection that it is about, until which is changed it stays; null: until the next try */
  about: string | null;
}

/** A problem as shown. */
export interface ProblemOptions {
  untilChanged?: boolean;
  level?: Problem["level"];
  isOfSaving?: boolean;
  /** the selection that was refused */
  asked?: MissionSelection;
}

/** Another user has saved what clashes with the changes on this page. */
export interface Conflict {
  actor: string | null;
  whose: string;
  at: string;
  /** the revision that the changes on this page were made from, and what it held where that is known */
  base: number;
  before: Version | null;
  theirs: Version;
  clashes: string[];
}

/** What the panel of reasons shows: one of these. */
export interface Why {
  /** a target's key */
  target?: string;
  /** place of a route */
  route?: number;
  /** place of the route that is changed by hand */
  manualEdit?: number;
  compare?: boolean;
  alternatives?: boolean;
}

// a route that is changed by hand

/** A waypoint: see hand_route.js. */
export interface HandPoint {
  position: number[];
  altitude_agl_m: number;
  /** over ground on the leg that leads to it; null: the UAV's own */
  speed_mps: number | null;
  /** its place in the stored route; null: it is put in */
  was: number | null;
  kind: Route["waypoints"][number]["kind"];
  target: number | null;
  isManual: boolean;
}

/** The server's faults of waypoints and legs, by index. */
export interface HandFaults {
  points: Map<number, string>;
  legs: Map<number, string>;
  other: string[];
}

/** A route that is being changed by hand: see hand_editing.js. */
export interface HandEdit {
  sequence: number;
  original: HandPoint[];
  points: HandPoint[];
  /** index of the waypoint that is chosen */
  chosen: number | null;
  /** the points while one is dragged */
  dragged: HandPoint[] | null;
  /** the server's last answer */
  look: HandLook | null;
  isCheckOld: boolean;
  /** why the request failed */
  unknown: string;
  faults: HandFaults;
  /** the changed legs; null while it is not known whether one is clear */
  legs: Map<number, { is_clear: boolean } | null>;
  canUndo: boolean;
  canRedo: boolean;
  isSaving: boolean;
}

// rehearsals

export interface RunningRehearsal {
  id: string | null;
  job: string | null;
  /** 0 to 1; null: not known */
  progress: number | null;
  message: string;
}

export interface RehearsalState {
  list: Rehearsal[] | null;
  detail: RehearsalDetail | null;
  /** index of the selected run */
  run: number;
  track: RehearsalTrack | null;
  running: RunningRehearsal | null;
  fault: string;
}

/** What a click on the map does. */
/** What a box or a lasso has found. */
export interface Caught {
  rows: PickedAsset[];
  /** rows that are chosen to be added */
  chosen: PickedAsset[];
  /** towers of lines that are picked whole: left out */
  covered: number;
  /** the area that was drawn: longitude, latitude */
  ring: number[][];
}

export type Tool = "point" | "box" | "lasso" | "line" | "stretch" | "place" | "rally" | "zone";

/** A plan that is done soonest by a number of UAVs, in short. */
export interface UavNumber {
  uavs: PickedUav[];
  done_s: number;
  length_m: number;
  flights: number;
  missed: number;
}

/** Plans by the number of UAVs. */
export interface UavNumbers {
  /** see keyOfNumbers */
  key: string;
  /** who could fly */
  candidates: PickedUav[];
  /** fewest UAVs first */
  rows: UavNumber[];
  /** the number that is being planned, null at the end */
  planning: number | null;
  /** before all numbers were planned */
  isStopped: boolean;
  fault: string;
}

/** The proof of the stored plan, which goes on in the background. */
export interface PlanProof {
  /** id */
  mission: string;
  /** of the plan */
  basis: string;
  /** of the plan as it is stored */
  planned_at: string;
  job: string | null;
  isStopping: boolean;
  isOver: boolean;
  /** the search came to its end: it did not fail, and was not cancelled */
  isFinished: boolean;
  /** share, 0 to 1 */
  progress: number;
  /** a better plan than the one on the page */
  better: PlanResult | null;
  /** what is better in it */
  words: string;
}

/** What the page knows: the state of its store. */
export interface MissionPageState {
  ground: Ground | null;
  fleet: FleetUav[];
  mission: Mission | null;
  name: string;
  selection: MissionSelection;
  canUndo: boolean;
  canRedo: boolean;
  plan: ShownPlan | null;
  /** of the map data as the server has it now */
  groundRevision: number | null;
  planIsStored: boolean;
  /** of the stored selection: see storedBasisOf */
  savedBasis: string | null;
  /** of unsaved changes that this browser brought back */
  restoredBasis: string | null;
  /** plans by the basis that they were made for */
  figures: Record<string, PlanResult>;
  planning: Planning | null;
  saving: boolean;
  problem: Problem | null;
  conflict: Conflict | null;
  /** what the server has */
  stored: Version | null;
  /** the server cannot be reached */
  isAway: boolean;
  /** other users who have the mission open */
  others: Present[];
  lastPlan: ShortPlan | null;
  /** the plan that was made last on this page, or before it was loaded again */
  shownPlan: ShortPlan | null;
  /** the basis that another plan is being made for, to compare */
  planningBeside: string | null;
  /** by basis: why that could not be planned */
  refusedBeside: Record<string, string>;
  uavNumbers: UavNumbers | null;
  proof: PlanProof | null;
  why: Why | null;
  /** where the pointer is on a strip or a profile */
  along: { sequence: number; at_m: number; isWished: boolean } | null;
  tool: Tool;
  /** the tower at which a stretch begins */
  stretchFrom: { id: number; label: string; centre: number[] } | null;
  litTarget: string | null;
  chosenTarget: string | null;
  chosenTargets: string[];
  /** place of the route under the pointer */
  lookedAt: number | null;
  chosenRoute: number | null;
  litZones: number[];
  /** what a box or a lasso has found, before it is added */
  caught: Caught | null;
  /** key of the failing returns that are pointed at */
  litReturn: string | null;
  hand: HandEdit | null;
  /** of the mission, newest first; null until they are read */
  commands: Command[] | null;
  returns: ReturnCheck[] | null;
  /** by id of the UAV; null: could not be read */
  connections: Map<number, UavConnection | null>;
  /** checks before start, as the page Fly shows them; null: not read */
  preflight: Preflight | null;
  isDispatching: boolean;
  arrival: "awaited" | "whole" | "failed"; // of the page's mission and the fleet: before, no list counts as empty
  rehearsal: RehearsalState;
}

export type MissionStore = Store<MissionPageState>;

/** What the actions of the page share: see actions.js. */
export interface MissionContext {
  store: MissionStore;
  history: ReturnType<typeof createHistory<MissionPageState, "selection">>;
  selection(): MissionSelection;
  /** one step of the history; false where it is the same */
  change(next: MissionSelection): boolean;
  problem(title: string, text: string, actions?: WayOut[], how?: ProblemOptions): void;
  /** shows an error; `actions` retry it */
  failed(title: string, error: unknown, actions?: WayOut[], how?: ProblemOptions): void;
  wordsOf(error: unknown): string;
  page: MissionPageData;
  drafts: ReturnType<typeof createDrafts>;
  /** progress of the running request */
  running: { stopping: AbortController | null };
  runningJob: ReturnType<typeof createRunningJob>;
}

/** What an operator does with the mission: see actions.js. */
export type MissionActions = ReturnType<typeof import("./actions/actions.js").createActions>;
