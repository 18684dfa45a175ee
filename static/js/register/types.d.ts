/** Shapes of registers: assets and zones as tables. */

export interface RegisterColumn<Row> {
  name: string;
  words: string;
  cell(row: Row): string;
  /** as the API names this order */
  sort?: string;
  isNumber?: boolean;
  /** hidden unless the user shows it */
  isOptional?: boolean;
}

export interface Register<Row> {
  key: string;
  words: string;
  /** the first one names the row */
  columns: RegisterColumn<Row>[];
  /** the order at first */
  order: string;
  /** address of the files without their ending */
  exports: string;
  /** address of the counts */
  summary: string;
  canEdit: boolean;
  name(row: Row): string;
  icon(row: Row): string;
  /** shows counts beside the filters */
  counted(counts: unknown): void;
  /** edits marked rows; resolves to whether rows changed */
  edit(marked: Marked): Promise<boolean>;
}

/** Marked rows: their ids, or null for all that the query finds. */
export interface Marked {
  count: number;
  ids: number[] | null;
  query: [string, string][];
}
