// A wave of a wave: far steeper than it looks.
float map(vec3 p) {
    p.y += 0.3 * sin(4.0 * p.x + 2.0 * sin(5.0 * p.z));
    float slab = abs(p.y) - 0.1;
    return max(slab, length(p.xz) - 1.4);
}
