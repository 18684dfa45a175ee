/** Shapes that the modules of the 3D view share. Places are in the frame: x east, y up, z south [m]. */

import type { LiveUav, Scene, WaypointKind } from "../api_types.d.ts";
import type { Palette } from "../domain/palette.js";
import type { LoadedMission } from "../record/load.js";
import type { TimeSpan } from "../record/player.js";
import type { ReplayEvent } from "../record/timeline.js";
import type { Pose } from "./cameras/rig.js";
import type { Flight } from "./flight/drawn_flight.js";
import type { makeFrame } from "./frame.js";
import type { GroundLabel } from "./geometry/labels.js";
import type { Wires } from "./geometry/wires.js";
import type { Task } from "./instruments/task.js";

export type Vector = [x: number, y: number, z: number];
/** Points of an outline, a hole or a way on the ground: x and z of each. */
export type Ring = number[][];
export type Frame = ReturnType<typeof makeFrame>;
export type HeightAt = (x: number, z: number) => number;

export type SourceKind = "plan" | "rehearsal" | "live" | "record";
/** What of a mission is wanted; without rehearsal or run the newest one, the worst of its runs. */
export interface WantedSource {
  kind: SourceKind;
  rehearsal?: string | null;
  run?: number | null;
}

export type SampleKind = "measured" | "estimated" | "planned" | "lost";
export interface Bound {
  along_m: number;
  across_m: number;
  bearing_deg: number;
  height_m: number | null;
}
/** What is known of a UAV at one moment; null: not known. */
export interface FlightSample {
  at_ms: number;
  position: number[];
  altitude_amsl_m?: number | null;
  altitude_relative_m?: number | null;
  heading_deg?: number | null;
  speed_mps?: number | null;
  climb_mps?: number | null;
  battery_percent?: number | null;
  roll_deg?: number | null;
  pitch_deg?: number | null;
  waypoint?: number | null;
  isInAir?: boolean | null;
  bound?: Bound | null;
  mode?: string | null;
}
/** A piece of a track by time; it has a sample at least. */
export interface Piece {
  kind: SampleKind;
  samples: FlightSample[];
}
/** A sample at a moment, between what is known. */
export interface Moment extends FlightSample {
  kind: SampleKind;
  /** of the report before it */
  since_ms?: number | null;
  /** after the last report */
  isOver?: boolean;
}

export interface PlannedPlace {
  sequence: number;
  position: number[];
  altitude_amsl_m: number | null;
  altitude_relative_m: number;
  at_s: number | null;
  target: number | null;
  kind?: WaypointKind;
}
export interface FlightRoute {
  place: number;
  uav: number | null;
  name: string;
  isSimulated?: boolean;
  planned: PlannedPlace[];
  pieces: Piece[];
  /** of a live source: the feed's data of its UAV */
  uavNow?: LiveUav;
}
/** A target with the label it has on all stages. */
export interface SourceTarget {
  place: number;
  label: string;
  name: string;
  asset: number | null;
  position: number[];
  /** place of the UAV that flies to it */
  route: number;
}
export interface Wind {
  speed_mps: number;
  from_deg: number;
}
/** What the view shows of a mission. */
export interface FlightSource {
  kind: SourceKind;
  isSimulated: boolean;
  departs_ms: number | null;
  hasDate: boolean;
  span: TimeSpan | null;
  routes: FlightRoute[];
  /** of the mission's UAVs by their places; empty: those of the places */
  colours: number[];
  targets: SourceTarget[];
  events: ReplayEvent[];
  windAt(at_ms: number, height_m: number): Wind | null;
  /** of a rehearsal */
  rehearsal?: string;
  run?: number;
  runs?: { sequence: number; words: string }[];
  /** of a record: the mission still flies */
  isGrowing?: boolean;
  /** of a record: puts in what has come since */
  renew?(loaded: LoadedMission): void;
  /** of a live one: what was flown has grown */
  revision?: number;
  /** of a live one: returns whether anything is another than before */
  take?(received: { uavs: readonly LiveUav[]; now_ms: number }): boolean;
  /** of a live one: where a UAV is shown */
  momentAt?(route: FlightRoute, now_ms: number): Moment | null;
  isGliding?(now_ms: number): boolean;
}

/** A moment of a UAV as it is drawn. */
export type PlacedMoment = ReturnType<Flight["at"]>;
export interface DrawnUav extends PlacedMoment {
  task: Task;
  /** of its last report, where it is not measured */
  report: Vector | null;
  colour: string;
  name: string;
}

export interface ScenePalette extends Palette {
  water: string;
  road: string;
  pressed: string;
  panel: string;
  hairline: string;
  accent: string;
}

/** A surface of triangles: x, y, z of each vertex, and three vertices of each triangle. */
export interface Surface {
  vertices: Float32Array;
  index: Uint32Array;
  uv?: Float32Array;
}
/** A surface while it is made. */
export interface SurfaceParts {
  vertices: number[];
  index: number[];
}
/** Members of supports: x, y, z of both ends, how wide, and which tone. */
export interface Members {
  ends: Float32Array;
  width_m: Float32Array;
  tone: Uint8Array;
}
/** Polylines: x, y, z of each point, and the first point of each line, with the number of points at the end. */
export interface Polylines {
  points: Float64Array;
  first: Uint32Array;
}
/** Lines that are drawn: ends, tints and sizes of each segment. */
export type Segments = [ends: Float32Array, tints: Float32Array, sizes: Float32Array];

/** How members of a support are drawn: from start to end, as [across, up, along] of it. */
export type DrawMember = (start: Vector, end: Vector, width_m: number, tone?: number) => void;
export interface DrawSupport {
  outline: DrawMember;
  fine: DrawMember;
}

export interface Size {
  width: number;
  height: number;
}
/** A place on the screen in CSS pixels, and how far away it is [m]. */
export interface Projected {
  x: number;
  y: number;
  away_m: number;
}
/** The picture as it stands, on a canvas of its own, with so many of its pixels a CSS pixel. */
export interface CopiedPicture {
  picture: HTMLCanvasElement;
  scale: number;
}
/** For measurements: what was drawn since the last asking, and what the graphics hold. */
export interface Figures {
  calls: number;
  triangles: number;
  geometries: number;
  textures: number;
  programs: number;
  frames: number;
  script_ms: number;
  longest_ms: number;
}
export interface FrameTime {
  dt_s: number;
  now_ms: number;
}
export interface PictureOptions {
  scene: Scene;
  palette: ScenePalette;
  /** before each picture: moves what moves and returns whether the next picture is wanted at once */
  draw(time: FrameTime): boolean;
  /** the graphics context */
  onLost?(): void;
  onFound?(): void;
}
/** What is seen in one frame. */
export interface Look {
  pose: Pose;
  /** distance to the target */
  distance_m: number;
  /** round the camera */
  room_m: number;
  drawn: DrawnUav[];
  chosen: number | null;
  looked: number | null;
  /** the one that looks */
  hidden: number | null;
  at_ms: number | null;
  wind: Wind | null;
  dt_s: number;
}
/** A flight as it is seen: in space, or from above where there is no WebGL. */
export interface Picture {
  kind: "3d" | "2d";
  size: Size;
  frame: Frame;
  groundAt: HeightAt;
  request(): void;
  wires(): Wires;
  labels(): GroundLabel[];
  isNight(): boolean;
  /** begins_ms: from which times are counted, so that they stay exact */
  showFlight(flight: Flight, count: number, begins_ms: number): void;
  showFlown(flight: Flight, begins_ms: number): void;
  setPalette(palette: ScenePalette): void;
  setDate(date: Date): void;
  /** Returns whether the next picture is another one. */
  show(look: Look): boolean;
  project(place: Vector): Projected | null;
  copy(): CopiedPicture;
  figures?(): Figures;
  dispose(): void;
}

/** What a view looks at; the targets' places are those of the mission. */
export interface StageState {
  mission: { id: string; name: string };
  source: FlightSource;
  /** place of the UAV that is followed */
  chosen: number | null;
  target: number | null;
  isFlat: boolean;
  now_ms(): number;
}
export interface PlacedTarget extends SourceTarget {
  place3d: Vector;
}
