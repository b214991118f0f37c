// Operators that change their argument and tell which cell it was.
void pR(inout vec2 p, float a) {
    p = cos(a) * p + sin(a) * vec2(p.y, -p.x);
}

float pMod1(inout float p, float size) {
    float halfsize = size * 0.5;
    float c = floor((p + halfsize) / size);
    p = mod(p + halfsize, size) - halfsize;
    return c;
}

float fBox(vec3 p, vec3 b) {
    vec3 d = abs(p) - b;
    return length(max(d, vec3(0))) + max(min(d, vec3(0)).x, max(min(d, vec3(0)).y, min(d, vec3(0)).z));
}

float fOpUnionRound(float a, float b, float r) {
    vec2 u = max(vec2(r - a, r - b), vec2(0));
    return max(r, min(a, b)) - length(u);
}

float map(vec3 p) {
    pR(p.xz, 0.4);
    float c = pMod1(p.x, 1.6);
    float box = fBox(p, vec3(0.4));
    return fOpUnionRound(box, length(p - vec3(0.3, 0.4, 0.0)) - 0.3, 0.2);
}
