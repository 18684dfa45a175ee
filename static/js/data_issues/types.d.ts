/** Shapes of the page of data issues that the API leaves open. */

import type { DataIssueFeature, DataIssueProperties, Offer } from "../api_types.d.ts";
import type { Geometry } from "../map/types.d.ts";

/** Figures of an issue's kind (inspection/quality). */
export interface DataIssueDetails {
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
export type DataIssueOffer = Omit<Offer, "choices" | "preview"> & {
  choices: { value: unknown; words: string }[];
  preview: Collection | null;
};

export type DataIssue = Omit<DataIssueFeature, "properties" | "geometry"> & {
  geometry: { type: "Point"; coordinates: number[] } | { type: "MultiPoint" | "LineString"; coordinates: number[][] };
  properties: Omit<DataIssueProperties, "details" | "repairs"> & {
    details: DataIssueDetails;
    repairs: DataIssueOffer[];
  };
};

export interface DataIssueFilter {
  state: DataIssueProperties["state"];
  kinds: Set<string>;
  text: string;
  inView: boolean;
}
