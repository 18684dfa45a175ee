/** Shapes that the modules of a mission's report share. */

import type { AlertLevel, RecordRoute, TargetState } from "../api_types.d.ts";
import type { Box, MapPage } from "../map/types.d.ts";
import type { Track } from "../record/track.js";

/** What the server writes into the page. */
export interface ReportPage extends MapPage {
  mission: string;
  canFly: boolean;
  bounds: Box | null;
  extent: Box | null;
}

/** A target as a strip shows it. */
export interface StripTarget {
  place: number;
  label: string;
  number: number;
  state: TargetState;
  /** when it was reached */
  at_ms: number | null;
  title: string;
}
export type ReachedTarget = StripTarget & { at_ms: number };

export interface StripAlert {
  at_ms: number;
  level: AlertLevel;
  title: string;
}

/** A route of the record with what the replay draws of it. */
export interface ReplayRoute extends RecordRoute {
  colour: number;
  isOver: boolean;
  track: Track;
  targets: StripTarget[];
  alerts: StripAlert[];
}

/** The selected leg: sequences of its waypoints. */
export interface LookedLeg {
  place: number;
  from: number;
  to: number;
}
