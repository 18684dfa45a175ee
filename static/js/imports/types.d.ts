/** Types of the imports page, which refine open types of the API. */

import type {
  Proposal as ApiProposal,
  ChangeFeature,
  ChangeProperties,
  ZoneSet,
  ZoneSetVersion,
} from "../api_types.d.ts";
import type { Geometry } from "../map/types.d.ts";

export type ImportKind = ApiProposal["kind"];
export type Action = ChangeProperties["action"];
export type Parameters = Record<string, unknown>;

/** A column of an asset file. */
export interface Column {
  name: string;
  samples?: unknown[];
  is_withheld?: boolean;
  /** how many rows have each value, where they are few */
  values?: Record<string, number>;
}

/** What a reader of files found (inspection/services/proposals). */
export interface Summary {
  needs_mapping?: boolean;
  words?: string;
  notes?: unknown;
  set?: string;
  extent?: number[] | null;
  preview?: { features: { geometry: Geometry }[] };
  columns?: Column[];
  mapping?: Mapping;
  suggested_mapping?: Mapping;
  layers?: string[];
  layer?: string;
  crs?: string;
  format?: string;
  /** of a refused file: it can be read without the records that have the faults */
  can_leave_out?: boolean;
  /** of an asset file: how many assets get one */
  external_ids?: number;
  lowest_m?: number;
  highest_m?: number;
  vertical_datum?: string;
  not_read?: UnreadRecord[];
  /** numbers of changes of each kind of asset, by action */
  by_kind?: Record<string, Record<string, number>>;
  /** how many assets of each kind “Replace the whole region” would remove as well */
  replaced_region_removes?: Record<string, number>;
  [name: string]: unknown;
}

/** A record of a zone file with a fault. */
export interface UnreadRecord {
  place: string;
  message: string;
  name: string;
  position: number[] | null;
  /** west, south, east, north of its readable part */
  bbox: number[] | null;
}

export interface Mapping {
  kind?: string | { column: string; values?: Record<string, string> } | null;
  columns?: Record<string, string>;
  units?: Record<string, string>;
  geometry?: Record<string, string>;
}

export type Proposal = Omit<ApiProposal, "summary" | "parameters" | "provenance"> & {
  summary: Summary;
  parameters: {
    crs?: string;
    replace_region?: boolean;
    leave_out_faulty?: boolean;
    excluded?: string[];
    undo?: number;
  } & Parameters;
  provenance: { licence?: string; attribution?: string; source_address?: string; fetched_at?: string };
};

export type Change = Omit<ChangeFeature, "geometry" | "type" | "properties"> & {
  geometry: Geometry | null;
  properties: Pick<ChangeProperties, "action" | "before" | "after"> & Partial<ChangeProperties>;
};

export interface ImportsState {
  proposals: Proposal[] | null;
  /** address of the next page */
  next: string | null;
  current: Proposal | null;
  busy: string | null;
  changes: Change[];
  /** rows of a long difference that are listed */
  listed: number;
  action: string;
  /** kind of asset, or zone, that the list is narrowed to */
  subject: string;
  /** keys of changes that are left out */
  excluded: string[];
  lit: number | null;
  selected: number | null;
}

/** What the panel of a proposal asks the page to do. */
export interface ProposalActs {
  back(): void;
  cancel(proposal: Proposal): Promise<void>;
  /** seen: places of the records that are not read */
  apply(overwrites: boolean, seen: string[]): Promise<void>;
  /** how many of the counted changes are left out */
  leftOut(overwrites: boolean): number;
  discard(): Promise<void>;
  readAgain(parameters: Parameters): Promise<void>;
  place(position: number[]): void;
  versions(name: string): Promise<{ set: ZoneSet | null; rows: ZoneSetVersion[] }>;
  rollBack(set: ZoneSet, version: number): Promise<boolean>;
  undo(proposal: Proposal): Promise<boolean>;
}

/** A file on its way to the server. */
export interface UploadItem {
  name: string;
  size: number;
  mark: string;
  kind: ImportKind;
  file: File | null;
  phase: "chosen" | "sending" | "waiting" | "starting" | "failed" | "lost";
  received: number;
  waits_s: number;
  problem: string;
  parameters: Record<string, string>;
  provenance: Record<string, string>;
  uploadId: string | null;
  controller: AbortController | null;
  /** ends the wait for the connection */
  wake: (() => void) | null;
}

/** What of it the browser remembers. */
export type RememberedUpload = Pick<
  UploadItem,
  "name" | "size" | "kind" | "parameters" | "provenance" | "uploadId" | "received"
> & { mark: string; at: number };

export interface UploadActs {
  start(item: UploadItem): void;
  stop(item: UploadItem): void;
  choose(item: UploadItem): void;
  drop(item: UploadItem): void;
  kind(item: UploadItem, kind: ImportKind): void;
  change(item: UploadItem): void;
}

/** How a file that is sent reports, and is ended. */
export interface SendHints {
  notify(progress: { received?: number; waits_s: number }): void;
  /** is given a function that ends a wait */
  nudge?(wake: () => void): void;
  signal?: AbortSignal;
}
