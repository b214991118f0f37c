// Where meshes stand and what they are made of.

struct MeshPlace {
    // The mesh's axes as they stand in the scene, scaled.
    x: vec3f,
    roughness: f32,
    y: vec3f,
    metallic: f32,
    z: vec3f,
    reflectivity: f32,
    // Where the mesh's origin is, in the space of the module's `p`.
    origin: vec3f,
    // Which of the materials that are not the same everywhere; above all of them: none.
    material: u32,
    color: vec3f,
    // 1 where its file says where it lies on images.
    mapped: u32,
    emission: vec3f,
    padding: u32,
}

@group(2) @binding(0) var<storage, read> meshes: array<MeshPlace>;
