/** Where the map library is, said once. */

import * as maplibre from "/static/lib/maplibre-gl/maplibre-gl.mjs";

maplibre.setWorkerUrl(new URL("/static/lib/maplibre-gl/maplibre-gl-worker.mjs", location.origin).href);

export { maplibre };
