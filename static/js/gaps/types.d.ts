/** Shapes of the page of data gaps that the API leaves open. */

import type { GapFeature, GapProperties, Offer } from "../api_types.d.ts";
import type { Geometry } from "../map/types.d.ts";

/** Figures of a gap's kind (inspection/quality). */
export interface GapDetails {
  nearest?: number[];
  is_advisory?: boolean;
  is_impossible?: boolean;
  beyond_m?: number;
  line_m?: number;
  without_tower_m?: number;
  network_m?: number;
  tagged?: string;
}

export interface Collection {
  features: { geometry: Geometry }[];
}

/** A repair that is offered, with the values of its parameter, and what it would draw. */
export type GapOffer = Omit<Offer, "choices" | "preview"> & {
  choices: { value: unknown; words: string }[];
  preview: Collection | null;
};

export type Gap = Omit<GapFeature, "properties" | "geometry"> & {
  geometry: { type: "Point"; coordinates: number[] } | { type: "MultiPoint" | "LineString"; coordinates: number[][] };
  properties: Omit<GapProperties, "details" | "repairs"> & { details: GapDetails; repairs: GapOffer[] };
};

export interface GapFilter {
  state: GapProperties["state"];
  kinds: Set<string>;
  text: string;
  inView: boolean;
}
