/** Address of the 3D library, in one place. */

export * from "/static/lib/three/three.module.min.js";
