/** Shapes that the modules of the map and its pages share. Positions are longitude, latitude [deg]; boxes west, south, east, north. */

import type { GeoJSONSource, Map as MapLibreMap } from "/static/lib/maplibre-gl/maplibre-gl.mjs";
import type { Palette } from "../domain/palette.js";

export type Position = [number, number];
export type Box = [number, number, number, number];
export type ScreenPoint = { x: number; y: number };
export type PickKind = "tower" | "bridge" | "railway" | "line" | "zone";
export type Geometry =
  | { type: "Point"; coordinates: number[] }
  | { type: "LineString" | "MultiPoint"; coordinates: number[][] }
  | { type: "Polygon" | "MultiLineString"; coordinates: number[][][] }
  | { type: "MultiPolygon"; coordinates: number[][][][] };

/** What of the infrastructure or the zones lies at a place of the map, as its tile describes it. */
export interface MapThing {
  kind: PickKind;
  /** source layer of the tiles */
  layer: string;
  id: number;
  properties: ThingProperties;
  geometry: Geometry;
}

/** Attributes of a feature of the vector tiles (inspection/selectors/tiles). */
export interface ThingProperties {
  id: number;
  label: string;
  kind?: string;
  subtype?: string;
  ref?: string;
  name?: string;
  operator?: string;
  detail?: string;
  voltage?: number;
  voltages?: string;
  length_m?: number;
  flyable?: boolean;
  restriction?: string;
  reason?: string;
  schedule?: string;
  lower_limit_m?: number;
  lower_reference?: string;
  upper_limit_m?: number;
  upper_reference?: string;
  [name: string]: unknown;
}

export interface RasterMap {
  tiles: string;
  attribution: string;
}

/** A named place with map data. */
export interface Region {
  id: number;
  name: string;
  extent: Box;
  /** assets by kind */
  counts: Record<string, number>;
  is_synthetic: boolean;
  attribution: string[];
}

/** Where the user worked last. */
export interface LastView {
  zoom: number;
  longitude: number;
  latitude: number;
}

/** What the server writes into a page with a map. */
export interface MapPage {
  baseMap: RasterMap;
  satellite: RasterMap;
  regions?: Region[];
  view?: LastView | null;
  /** of the region where the user works */
  extent?: Box | null;
  canCurate?: boolean;
}

export interface StyleOptions {
  tilesAddress: string;
  baseMap?: RasterMap;
  satellite?: RasterMap;
  /** "base-map", "satellite" or "" */
  under?: string;
}

export interface MapView {
  map: MapLibreMap;
  palette(): Palette;
  opensAtPlace: boolean;
  /** Whether the map opened where its user worked last. */
  opensAtLastView: boolean;
  /** The extent of the region in the middle of the map, else of the one where the user works. */
  home(): Box | null;
  ready: Promise<unknown>;
  recolour(): void;
  putUnder(name: string): void;
  show(layers: string[], visible: boolean): void;
  fit(box: Box | null, how?: { animate?: boolean }): void;
}

/** A fault of MapLibre: its source and tile. */
export interface MapFault {
  sourceId?: string;
  error?: { name?: string; message?: string; status?: number };
  tile?: { tileID: { canonical: { x: number; y: number; z: number } } };
}

export interface MapOptions {
  baseMap?: RasterMap;
  satellite?: RasterMap;
  under?: string;
  /** the map's name for screen readers */
  describe: string;
  /** of what the page is about: it comes before the last view */
  bounds?: Box | null;
  extent?: Box | null;
  regions?: Region[];
  view?: LastView | null;
}

/** A layer of the page that its layers menu switches. */
export interface SwitchedLayer {
  words: string;
  isOn(): boolean;
  turn(isOn: boolean): void;
}

/** What is known of the infrastructure as a whole: GET /ground. */
export interface Ground {
  attribution: string[];
  is_synthetic: boolean;
  extent: number[] | null;
}

export interface MapControls {
  attribute(): void;
  isMeasuring(): boolean;
  hover(place: Position | null): void;
  /** true where the click was for the measuring */
  click(place: Position): boolean;
  setGround(ground: Ground | null): void;
  closeTop(): boolean;
  switchMeasure: () => unknown;
  copyPlace: () => Promise<void>;
}

/** Shows words beside the pointer; a null key takes them away. `make` may call `fill` later with other content. */
export type Tip = (
  key: string | null,
  point?: ScreenPoint | null,
  make?: (fill: (content: (Node | string)[]) => void) => (Node | string)[],
  how?: { soon?: boolean },
) => void;

/** What clicks on the map do. */
export interface ClickHandlers {
  click(thing: MapThing | null, place: Position, point: ScreenPoint): unknown;
  hover(thing: MapThing | null, point: ScreenPoint | null, place: Position | null): unknown;
  box(box: Box): unknown;
  lasso?(ring: Position[]): unknown;
  tool(): string;
  /** those that count now; null: all */
  kinds(): string[] | null;
}

/** A place that a search found: it is gone to by position and zoom, or by its box. */
export interface FoundPlace {
  icon: string;
  /** one of the whole world, which comes after what is on the map */
  isTown?: boolean;
  label: string;
  detail: string;
  position?: number[];
  zoom?: number;
  box?: Box;
}

/** GeoJSON as a source of the map takes it. */
export type FeatureCollection = Exclude<Parameters<GeoJSONSource["setData"]>[0], string> & {
  type: "FeatureCollection";
};

export type { GeoJSONSource, MapLibreMap };
