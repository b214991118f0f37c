const float MR2 = 0.25;
const vec4 SCALE = vec4(-2.0, -2.0, -2.0, 2.0);

float map(vec3 pos) {
    vec4 p = vec4(pos, 1.0);
    vec4 p0 = p;
    for (int i = 0; i < 6; i++) {
        p.xyz = clamp(p.xyz, -1.0, 1.0) * 2.0 - p.xyz;
        float r2 = dot(p.xyz, p.xyz);
        p *= clamp(max(MR2 / r2, MR2), 0.0, 1.0) / MR2;
        p = p * SCALE + p0;
    }
    return (length(p.xyz) - 1.0) / p.w - 0.002;
}
