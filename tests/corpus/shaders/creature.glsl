struct Hit {
    float d;
    int id;
};

Hit closest(Hit a, Hit b) {
    if (a.d < b.d) return a;
    return b;
}

float ellipsoid(vec3 p, vec3 r) {
    float k0 = length(p / r);
    float k1 = length(p / (r * r));
    return k0 * (k0 - 1.0) / k1;
}

Hit scene(vec3 p) {
    Hit body = Hit(ellipsoid(p, vec3(0.5, 0.6, 0.7)), 1);
    vec3 q = vec3(abs(p.x), p.yz);
    Hit eye = Hit(length(q - vec3(0.25, 0.35, 0.5)) - 0.1, 2);
    Hit legs = Hit(length(q.xz - vec2(0.3, 0.1)) - 0.07, 3);
    legs.d = max(legs.d, abs(p.y + 0.7) - 0.3);
    return closest(closest(body, eye), legs);
}

float map(vec3 p) {
    Hit hit = scene(p);
    return hit.d;
}
