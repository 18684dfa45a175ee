/** Where the 3D library is, said once. */

export * from "/static/lib/three/three.module.min.js";
