/** Shapes that the modules of the fleet's page share. Positions are longitude, latitude [deg]. */

import type { ApiError, Options } from "../api.js";
import type { Base, Ground, UavFeature, UavNumbers, UavProperties, UavType } from "../api_types.d.ts";
import type { Child } from "../dom.js";
import type { Box, MapPage, Position } from "../map/types.d.ts";
import type { Field } from "../page/fields.js";
import type { Store } from "../store.js";

export type { Field, Ground, Position, Store };
export type Tab = "uavs" | "types" | "bases";

// An answer has every field; its description marks those as optional that need not be sent.
export type Uav = Required<Omit<UavProperties, "cruise_speed_mps">> & {
  id: number;
  position: Position;
  /** its own, its type's or the usual one */
  cruise_speed_mps: number;
};
export type FleetType = Required<UavType>;
export type FleetBase = Required<Omit<Base, "position">> & { position: Position };
export type Row = Uav | FleetType | FleetBase;
/** A row as the API answers with it. */
export type RowAnswer = UavFeature | UavType | Base;

/** What is written of a row, as the API takes it. */
export type UavBody = Pick<
  Uav,
  | "name"
  | "type"
  | "base"
  | "serial_number"
  | "mavlink_system_id"
  | "max_range_m"
  | "battery_wh"
  | "mass_kg"
  | "reserve_percent"
  | "max_airspeed_mps"
  | "battery_percent"
  | "sensor"
  | "end_action"
  | "link"
  | "allows_unsigned"
  | "is_simulated"
> & { position: Position | null; cruise_speed_mps: number | null };
export type TypeBody = Omit<FleetType, "id" | "uav_count" | "revision" | "updated_at">;
export type BaseBody = { name: string; position: Position | null; note: string };
export type Body = UavBody | TypeBody | BaseBody;

/** One of the three tabs: where its rows come from, what its table shows, how a row is named and described. */
export interface Kind<Item extends Row = Row> {
  tab: Tab;
  icon: string;
  words: string;
  /** the words of the button that adds one */
  one: string;
  count(count: number): string;
  /** of the search field */
  hint: string;
  path: string;
  columns: { words: string; class?: string; cell(row: Item): Child }[];
  facts(row: Item): Child[];
  deleted(row: Item): string;
  none: { title: string; text: string };
}

/** The selected row and tab. */
export interface Chosen {
  tab: Tab;
  id: number;
}

export interface FleetState {
  tab: Tab;
  uavs: Uav[] | null;
  types: FleetType[] | null;
  bases: FleetBase[] | null;
  numbers: UavNumbers | null;
  /** address of the next page of UAVs */
  next: string | null;
  text: string;
  state: string;
  type: string;
  base: string;
  chosen: Chosen | null;
  problem: { error: ApiError; again: () => unknown } | null;
}

/** What the server writes into the page. */
export interface FleetPage extends MapPage {
  canPlan: boolean;
  role: string;
  extent: Box | null;
}

export interface Places {
  uavs: Uav[] | null;
  bases: FleetBase[] | null;
}

/** What a form that is open asks of the map: null where there is none. */
export interface FleetMap {
  centre(): Position;
  /** chosen is drawn as such; the one that is edited is shown by the pin instead */
  show(places: Places, chosen: Chosen | null): void;
  lookAtAll(places: Places): void;
  look(position: Position): void;
  /** puts a pin to drag; notify(position) is called on each change */
  place(position: Position, notify: (position: Position) => void): void;
  endPlacing(): void;
  movePin(position: Position): void;
}

/** What a form is made of. */
export interface FormFields {
  fields: Field[];
  elements: Child[];
}

export interface Form {
  element: HTMLFormElement;
  first: HTMLElement;
  body(): Body;
  busy(isBusy: boolean): void;
  setPlace(position: Position): void;
  clear(): void;
  /** shows at the field what is wrong with it; what has no field stands above the form */
  notify(message: string, details?: Record<string, string[]> | null): void;
  ask(content: Node): void;
  label(name: string): string;
  words(name: string, value: unknown): string;
}

/** What an edit that was dropped or could not be saved is opened again with. */
export interface KeptEdit {
  body: Body;
  etag: Options | undefined;
}
