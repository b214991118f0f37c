// Reflections in planes through the origin, over and over.
vec3 n1 = normalize(vec3(1.0, 1.0, 0.0));

float map(vec3 z) {
    const float Scale = 2.0;
    vec3 a1 = vec3(1, 1, 1);
    vec3 a2 = vec3(-1, -1, 1);
    vec3 a3 = vec3(1, -1, -1);
    vec3 a4 = vec3(-1, 1, -1);
    vec3 c;
    int n = 0;
    float dist, d;
    while (n < 6) {
        c = a1; dist = length(z - a1);
        d = length(z - a2); if (d < dist) { c = a2; dist = d; }
        d = length(z - a3); if (d < dist) { c = a3; dist = d; }
        d = length(z - a4); if (d < dist) { c = a4; dist = d; }
        z = Scale * z - c * (Scale - 1.0);
        n++;
    }
    return (length(z) - 1.2) * pow(Scale, float(-n));
}
