/** Shapes that the modules of the live page share. Positions are longitude, latitude [deg]. */

import type {
  Alert,
  AlertLevel,
  Command,
  CommandKind,
  Live,
  LiveMission,
  LiveOffer,
  LiveUav,
  Mission,
  MissionEvent,
} from "../api_types.d.ts";
import type { Certainty } from "../domain/certainty.js";
import type { AskedKind } from "../domain/command_questions.js";
import type { FeedState } from "../live/feed.js";
import type { Box, Geometry, Ground, MapPage } from "../map/types.d.ts";
import type { Store } from "../store.js";
import type { MissionNumbers } from "./call_signs.js";
import type { FleetFilter } from "./fleet_groups.js";

/** What the server writes into the page. */
export interface MonitorPage extends MapPage {
  /** the only mission of the page; null: all that fly */
  mission: string | null;
  canFly: boolean;
  hasSimulated: boolean;
  /** of the only mission: a UAV of it is real, and is flown in simulation by a twin, in a copy of the mission */
  hasReal?: boolean;
  /** of the only mission; the page's title until the feed reports it */
  missionName?: string;
  bounds: Box | null;
  extent: Box | null;
}

/** A command that could not leave this device: tried again it is the same one. */
export interface UnsentCommand {
  kind: CommandKind;
  filled: Record<string, unknown>;
  key: string;
  message: string;
  isBusy: boolean;
  /** the page's time when it was given */
  at_ms: number;
}

/** at_ms: the page's time when it was given. */
export interface SendingCommand {
  kind: CommandKind;
  at_ms: number;
}

/** A route of another plan that is offered, in the colour of the UAV in the mission that flies now. */
export interface OfferedRoute {
  colour: number;
  geometry: Geometry;
}

/** Data of the feed, data read besides, and the operator's selection. */
export interface MonitorState extends Live {
  /** missions as the REST API shows them, by id */
  details: Map<string, Mission>;
  /** lines flown so far, by UAV; a silence begins another part */
  flown: Map<number, number[][][]>;
  offered: OfferedRoute[];
  ground: Ground | null;
  /** of missions, on the page of all: from two on they stand before the letters */
  numbers: MissionNumbers;
  /** of the fleet's list, on the page of all */
  filter: FleetFilter;
  /** id of a UAV */
  chosen: number | null;
  isFollowing: boolean;
  showsLog: boolean;
  /** what has happened, the newest first; null until it is read */
  events: MissionEvent[] | null;
  /** where the next page of older ones is; null: there is none */
  olderEvents: string | null;
  link: FeedState | null;
  /** since when `link` is so, by the server's clock */
  since_ms: number;
  /** when the last message came, by the server's clock; null before the first */
  received_ms: number | null;
  /** since then */
  silent_ms: number;
  /** commands that could not leave this device, by UAV */
  unsent: Map<number, UnsentCommand>;
  /** commands on their way to the server or not yet in the feed, by UAV */
  sending: Map<number, SendingCommand>;
  /** false until the first snapshot is shown: what comes later is news */
  isWhole: boolean;
  /** the server's time */
  now_ms: number;
}

export type MonitorStore = Store<MonitorState>;

/** What a UAV's route would be, or is. */
export interface OfferFigures {
  length_m: number;
  ends_at?: string | null;
  battery_percent?: number | null;
}

/** What another plan changes for a UAV. */
export interface OfferUav {
  place: number;
  /** in the plan that is offered; null: it flies none of it */
  continuation_place: number | null;
  name: string;
  change: string;
  before?: OfferFigures | null;
  after?: OfferFigures | null;
  why: string;
  gained: number[];
  lost: number[];
}

/** A target that another UAV would fly to, or none (`to` null). */
export interface OfferTarget {
  label: string;
  from: number | null;
  to: number | null;
  message?: string;
}

/** LiveOffer.difference (missions/continuing): empty while the plan is computed. */
export interface OfferDifference {
  uavs?: OfferUav[];
  targets?: OfferTarget[];
  unreached?: number;
  valid_until?: string | null;
}

/** LiveOffer.cause */
export interface OfferCause {
  zone_name?: string;
  uav_name?: string;
  /** labels of the targets before and behind the zone */
  leg?: [string | null, string | null];
}

/** Text of a live page and whether it reports a fault. */
export interface Told {
  words: string;
  isBad: boolean;
}

/** Where a UAV may be 95 of 100 times. */
export interface Bound {
  along_m: number;
  across_m: number;
  bearing_deg: number;
}

/** A UAV as the map marks it; `isMarked`: as simulated. */
export interface MarkedUav {
  id: number | string;
  name: string;
  letter: string;
  place: number | null;
  colour: number | null;
  position: number[];
  heading_deg: number | null;
  certainty: Certainty;
  fact: string;
  isMarked: boolean;
  isChosen: boolean;
  /** worst level of its open alerts; only where there are alerts */
  alarm?: AlertLevel | null;
}

/** A UAV as the live map draws it with its last report and its estimate. */
export interface DrawnUav extends Omit<MarkedUav, "id" | "isMarked"> {
  id: number;
  isSimulated: boolean;
  bound: Bound | null;
  last: number[] | null;
  words: string;
}

/** A line flown, in parts. */
export interface FlownLine {
  colour: number | null;
  parts: number[][][];
}

export interface PlannedLine {
  sequence: number;
  geometry: Geometry | null;
  colour: number;
}

/** Commands of the operator from the live page. */
export interface Commanding {
  /** opener: the button out of which the question grows */
  ask(id: number, kind: AskedKind, opener?: HTMLElement | null): Promise<void>;
  askAll(kind: "hold" | "return", opener?: HTMLElement | null): Promise<void>;
  /** a command that could not leave this device */
  tryAgain(id: number): Promise<void>;
  giveUp(id: number): void;
}

export type { Alert, Command, LiveMission, LiveOffer, LiveUav };
