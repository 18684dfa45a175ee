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
  /** what the button that edits marked rows says */
  editWords(count: number): string;
  /** edits marked rows; resolves to whether rows changed */
  edit(marked: Marked<Row>): Promise<boolean>;
}

/** Marked rows, or null for all that the query finds. */
export interface Marked<Row> {
  count: number;
  rows: Row[] | null;
  query: [string, string][];
}

/** One fact that can be the same for many rows. */
export interface BulkFact {
  words: string;
  /** read() returns undefined where what is written is no value */
  field(): { element: HTMLElement; read(): unknown };
  /** what to write instead of what is no value */
  fault?: string;
}

/** How rows of a register are corrected together. */
export interface BulkEdit<Row> {
  /** address of the edits; with /undo the way back */
  path: string;
  facts: Record<string, BulkFact>;
  /** the rows as a request names them */
  chosen(rows: Row[]): object;
  note: string;
  words: {
    change(count: number): string;
    changed(count: number): string;
    undone(count: number): string;
    kept(count: number): string;
    tooMany(most: string): string;
  };
  reload(): unknown;
}
