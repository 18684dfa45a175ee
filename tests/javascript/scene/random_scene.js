/** A made-up scene with hills, lines and zones, the same for the same seed; shaped as GET /api/v1/scene answers. */

import { makeFrame } from "../../../static/js/scene/frame.js";

/** Numbers from 0 to 1, the same for a seed. Source: mulberry32. */
export function drawer(seed) {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let mixed = Math.imul(state ^ (state >>> 15), state | 1);
    mixed ^= mixed + Math.imul(mixed ^ (mixed >>> 7), mixed | 61);
    return ((mixed ^ (mixed >>> 14)) >>> 0) / 4_294_967_296;
  };
}

const [WEST, NORTH, STEP, POSTS] = [10, 56.05, 0.0005, 81];

export function hill_m(lon, lat) {
  return 210 + 60 * Math.sin((lon - WEST) * 260) * Math.cos((lat - NORTH) * 340) + 900 * (lon - WEST);
}

export const RULES = {
  earth_sag_share: 0.85,
  open_top_agl_m: 180,
  rail_wire_agl_m: 8,
  catenary_m: 1500,
  most_sag_share: 0.5,
};

export function randomScene(seed, { towers = 60 } = {}) {
  const next = drawer(seed);
  const between = (low, high) => low + (high - low) * next();
  const altitude_amsl_m = [];
  for (let row = 0; row < POSTS; row += 1) {
    for (let column = 0; column < POSTS; column += 1)
      altitude_amsl_m.push(hill_m(WEST + column * STEP, NORTH - row * STEP));
  }
  const supports = Array.from({ length: towers }, (_, number) => {
    const position = [WEST + 0.002 + (0.036 * number) / towers, NORTH - between(0.015, 0.02)];
    const height_m = between(22, 78);
    const slots = [
      [-4, height_m - 8],
      [4, height_m - 8],
      [5.5, height_m - 14],
      [-5.5, height_m - 14],
      [4.6, height_m - 19],
      [-4.6, height_m - 19],
    ];
    const arms = [8, 14, 19].map((down, level) => [
      height_m - down + 2,
      -[4.2, 5.8, 4.9][level],
      [4.2, 5.8, 4.9][level],
    ]);
    const form = ["lattice", "tubular", "wooden", "h-frame", "guyed", "stake", "portal"][number % 7];
    return {
      id: number,
      label: `Tower ${number}`,
      kind: "tower",
      form,
      position,
      ground_amsl_m: hill_m(...position),
      height_m,
      height_source: "assumed",
      likely_m: height_m,
      voltage_v: 132_000,
      is_anchor: false,
      bearing_deg: between(70, 110) + (number % 3 === 0 ? 180 : 0),
      arms,
      slots,
      earth: [[0, height_m]],
    };
  });
  const spans = supports.slice(1).map((_, number) => ({
    from: number,
    to: number + 1,
    lines: [1],
    voltage_v: 132_000,
    phases: number % 2 ? 6 : 3,
    earth: 1,
    length_m: 0,
    sag_m: between(0.5, 14),
  }));
  const circle = Array.from({ length: 49 }, (_, at) => [
    WEST + 0.02 + 0.004 * Math.cos((at * Math.PI) / 24),
    NORTH - 0.02 + 0.002 * Math.sin((at * Math.PI) / 24),
  ]);
  circle[48] = circle[0];
  const [a, b, c, d] = [WEST + 0.005, NORTH - 0.012, WEST + 0.014, NORTH - 0.003];
  const notched = [
    [a, b],
    [c, b],
    [c, d],
    [(a + c) / 2, (b + d) / 2],
    [a, d],
    [a, b],
  ];
  const hole = [
    [0.3, 0.2],
    [0.7, 0.2],
    [0.5, 0.3],
  ].map(([u, v]) => [a + (c - a) * u, b + (d - b) * v]);
  const zone = (id, polygons, lower, upper, schedule = null) => ({
    id,
    name: `Zone ${id}`,
    restriction: "",
    polygons,
    lower,
    upper,
    lower_limit: null,
    upper_limit: null,
    schedule,
    schedule_words: "",
  });
  return {
    box: [WEST, NORTH - (POSTS - 1) * STEP, WEST + (POSTS - 1) * STEP, NORTH],
    clip: [WEST - 0.02, NORTH - 0.06, WEST + 0.06, NORTH + 0.02],
    origin: { position: [WEST + 0.02, NORTH - 0.02], altitude_amsl_m: 200 },
    ground: {
      kind: "terrain",
      west_deg: WEST,
      north_deg: NORTH,
      step_lon_deg: STEP,
      step_lat_deg: STEP,
      columns: POSTS,
      rows: POSTS,
      altitude_amsl_m,
    },
    supports,
    spans,
    railways: [
      {
        id: 5,
        label: "Track",
        kind: "rail",
        tracks: 2,
        is_electrified: true,
        line: [
          [WEST + 0.001, NORTH - 0.03],
          [WEST + 0.02, NORTH - 0.028],
          [WEST + 0.038, NORTH - 0.033],
        ],
      },
    ],
    bridges: [
      {
        id: 6,
        label: "Bridge",
        is_named: true,
        carries: "a railway",
        deck_amsl_m: 330,
        deck_source: "tag",
        height_m: 30,
        height_source: "tag",
        polygons: [
          [
            [
              [WEST + 0.018, NORTH - 0.0281],
              [WEST + 0.022, NORTH - 0.0281],
              [WEST + 0.022, NORTH - 0.0287],
              [WEST + 0.018, NORTH - 0.0287],
              [WEST + 0.018, NORTH - 0.0281],
            ].map((at) => [...at]),
          ],
        ],
      },
    ],
    zones: [
      zone(1, [[circle]], { above: "ground", m: 0 }, { above: "ground", m: 120 }),
      zone(2, [[notched, [...hole, hole[0]]]], { above: "sea", m: 320 }, { above: "sea", m: 410 }),
      zone(
        3,
        [
          [
            [
              [WEST - 0.02, NORTH - 0.06],
              [WEST + 0.06, NORTH - 0.06],
              [WEST + 0.06, NORTH - 0.035],
              [WEST - 0.02, NORTH - 0.035],
              [WEST - 0.02, NORTH - 0.06],
            ],
          ],
        ],
        { above: "ground", m: 30 },
        { above: "open", m: null },
      ),
    ],
    rules: RULES,
    left_out: { supports: 0, spans: 0, railways: 0, bridges: 0, zones: 0 },
  };
}

/** Steep ground as a terrain model has it: { scene: { ground, zones, origin, clip }, frame }, posts every 60 m, some 1,000 m from valley to peak. */
export function mountains(seed, { posts = 120 } = {}) {
  const next = drawer(seed);
  const step = 0.00054;
  const waves = Array.from({ length: 24 }, (_, at) => {
    const size = 1.35 ** at;
    return { u: (next() - 0.5) * size * 60, v: (next() - 0.5) * size * 60, phase: next() * 6.3, high: 260 / size };
  });
  const height = (column, row) =>
    1_000 +
    waves.reduce((sum, { u, v, phase, high }) => sum + high * Math.sin((u * column + v * row) / posts + phase), 0);
  const altitude_amsl_m = Array.from(
    { length: posts * posts },
    (_, at) => Math.round(height(at % posts, Math.floor(at / posts)) * 100) / 100,
  );
  const [west, north] = [85, 28];
  const [east, south] = [west + step * (posts - 1), north - step * (posts - 1)];
  const origin = { position: [(west + east) / 2, (south + north) / 2], altitude_amsl_m: 1_000 };
  const box = (west_, south_, east_, north_) =>
    [
      [west_, south_],
      [east_, south_],
      [east_, north_],
      [west_, north_],
      [west_, south_],
    ].map(([u, v]) => [west + u * (east - west), south + v * (north - south)]);
  const zone = (id, outline, lower, upper) => ({
    id,
    name: `Zone ${id}`,
    restriction: "",
    polygons: [[outline]],
    lower,
    upper,
    lower_limit: null,
    upper_limit: null,
    schedule: null,
    schedule_words: "",
  });
  return {
    frame: makeFrame(origin),
    scene: {
      origin,
      clip: [west, south, east, north],
      ground: {
        kind: "terrain",
        west_deg: west,
        north_deg: north,
        step_lon_deg: step,
        step_lat_deg: step,
        columns: posts,
        rows: posts,
        altitude_amsl_m,
      },
      zones: [
        zone(1, box(0.1, 0.1, 0.6, 0.55), { above: "ground", m: 0 }, { above: "ground", m: 120 }),
        zone(2, box(0.3, 0.35, 0.95, 0.9), { above: "sea", m: 900 }, { above: "sea", m: 1_400 }),
        zone(3, box(0.55, 0.05, 0.9, 0.4), { above: "ground", m: 40 }, { above: "sea", m: 1_300 }),
      ],
    },
  };
}

/** Heights at which an upright line through a place meets triangles. */
export function heightsThrough(vertices, index, x, z) {
  const heights = [];
  for (let at = 0; at < index.length; at += 3) {
    const [a, b, c] = [index[at], index[at + 1], index[at + 2]].map((corner) =>
      vertices.subarray(corner * 3, corner * 3 + 3),
    );
    const whole = (b[0] - a[0]) * (c[2] - a[2]) - (c[0] - a[0]) * (b[2] - a[2]);
    const [u, v] = [
      ((x - a[0]) * (c[2] - a[2]) - (c[0] - a[0]) * (z - a[2])) / whole,
      ((b[0] - a[0]) * (z - a[2]) - (x - a[0]) * (b[2] - a[2])) / whole,
    ];
    if (u >= 0 && v >= 0 && u + v <= 1) heights.push(a[1] + u * (b[1] - a[1]) + v * (c[1] - a[1]));
  }
  return heights.sort((one, other) => one - other);
}
