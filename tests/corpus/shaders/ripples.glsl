// A ball with waves, and no factor at all.
float map(vec3 p) {
    float d1 = length(p) - 0.8;
    float d2 = 0.12 * sin(12.0 * p.x) * sin(12.0 * p.y) * sin(12.0 * p.z);
    return d1 + d2;
}
