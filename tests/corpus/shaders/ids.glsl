// Which body it is stands beside the distance.
vec2 opU(vec2 d1, vec2 d2) {
    return (d1.x < d2.x) ? d1 : d2;
}

float sdTorus(vec3 p, vec2 t) {
    return length(vec2(length(p.xz) - t.x, p.y)) - t.y;
}

vec2 map(in vec3 pos) {
    vec2 res = vec2(pos.y + 0.6, 0.0);
    res = opU(res, vec2(length(pos) - 0.4, 46.9));
    res = opU(res, vec2(sdTorus(pos - vec3(0.9, -0.3, 0.2), vec2(0.35, 0.12)), 25.0));
    res = opU(res, vec2(max(length(pos.xz + vec2(0.9, 0.4)) - 0.25, abs(pos.y) - 0.4), 12.5));
    return res;
}
