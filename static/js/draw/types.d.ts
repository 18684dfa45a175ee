/** Shapes that the drawing modules share. */

import type { Shape } from "../domain/geodesy.js";
import type { Position } from "../map/types.d.ts";

export type ShapeKind = Shape["kind"];

/** Place of a vertex in a shape: part, ring, index; of a ring: part, ring. */
export type VertexPath = number[];

/** A drawing: the shape, and the ring that the next vertex goes to; null once the shape is whole. */
export interface Drawing {
  shape: Shape;
  growing: VertexPath | null;
}

/** What is wrong with a shape, where, and along which sides. */
export interface Fault {
  message: string;
  position: number[] | null;
  sides: number[][][];
}

/** What can be taken hold of; `at` of a middle is the vertex before it. */
export interface Handle {
  role: "vertex" | "middle" | "radius" | "whole";
  at: VertexPath | null;
  position: number[];
}

/** Where a vertex would snap to. `asset` is null for the shape's own vertices. */
export interface Snapped {
  position: number[];
  asset: number | null;
  isVertex: boolean;
}

/** Report of an editor after each step. */
export interface EditorState {
  shape: Shape | null;
  faults: Fault[];
  chosen: VertexPath | null;
  isDrawing: boolean;
  isMoving: boolean;
  canUndo: boolean;
  canRedo: boolean;
}

export type { Position, Shape };
