/** Shapes that the pages of the infrastructure and the zones share. */

import type { Shape, ShapeKind } from "../draw/types.d.ts";
import type { Box, Geometry, MapPage, MapThing, PickKind, Position, ScreenPoint } from "../map/types.d.ts";
import type { Register } from "../register/types.d.ts";

/** What the server writes into a page of the curators. */
export interface GroundPage extends MapPage {
  userId: number;
  canCurate: boolean;
  canPlan: boolean;
  extent: Box | null;
}

/** Events of the map for a page; each is optional. */
export interface GroundHandlers {
  click?(thing: MapThing | null, place: Position, point: ScreenPoint): unknown;
  hover?(thing: MapThing | null, point: ScreenPoint | null, place: Position | null): unknown;
  box?(box: Box): unknown;
  tool?(): string;
  kinds?(): string[] | null;
  /** whether the pointer belongs to a drawing: then nothing is picked and no tip comes up */
  isBusy?(): boolean;
  /** whether the page itself rings what is pointed at */
  ringsItself?: boolean;
}

/** An asset or a zone as the API gives it. */
export interface RecordFeature {
  id: number;
  geometry: Geometry;
  properties: {
    revision: number;
    vanished_at?: string | null;
    follows?: boolean;
    circle?: { centre: number[]; radius_m: number } | null;
  };
}

export type Facts = Record<string, unknown>;

export interface RecordForm {
  element: HTMLFormElement;
  read(): Facts;
}

export interface ListRow {
  icon: string;
  name: string;
  detail: string;
  chip: string;
}

/** What a page of assets and one of zones have not in common. Feature is one in full, Row one of the list. */
export interface RecordKind<Feature extends RecordFeature, Row> {
  /** in the API */
  path: string;
  key: string;
  findWords: string;
  backWords: string;
  pickKinds: PickKind[];
  newChoices: { value: string; icon: string; words: string }[];
  newTitle(choice: string): string;
  choiceOf(feature: Feature): string;
  shapeKind(choice: string): ShapeKind;
  /** kind of a geometry check */
  checkKind(choice: string): string;
  /** facts of a new one that its form does not ask for */
  fixedFacts(choice: string): Facts;
  factsOf(feature: Feature): Facts;
  factsOfBody(body: Facts): Facts;
  title(feature: Feature): string;
  details(feature: Feature): (Node | string)[];
  /** the next act with one, where the user may; it is not offered for a deleted one */
  act?(feature: Feature): HTMLElement | null;
  /** what is shown between its facts and its history */
  more?(feature: Feature): HTMLElement | null;
  /** what follows when it is no longer shown, or anew */
  closed?(): void;
  form(feature: Feature | null, choice: string, kept: Facts | null): RecordForm;
  row(feature: Row): ListRow;
  /** parameters of the list besides a text and what the map shows; "" narrows nothing */
  narrowed(): Record<string, string | string[]>;
  /** what to do where a search finds nothing, and while there is nothing yet */
  noneFound: string;
  noneYet: { words: string; begin: string };
  /** the table under the map; without one the list is in the side */
  register?: Register<Row>;
}

/** An edit that was not saved, as the browser keeps it. */
export interface KeptEdit {
  id: number | null;
  choice: string;
  shape: Shape | null;
  facts: Facts;
  etag: string | null;
  kept_at?: string;
}
