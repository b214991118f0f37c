float body(int which, vec3 p) {
    float d;
    switch (which) {
        case 0: d = length(p) - 0.5; break;
        case 1: {
            vec3 q = abs(p) - 0.4;
            d = max(q.x, max(q.y, q.z));
            break;
        }
        case 2:
        case 3: d = max(length(p.xz) - 0.4, abs(p.y) - 0.5); break;
        default: d = dot(abs(p), vec3(0.57735)) - 0.4;
    }
    return d;
}

float map(vec3 p) {
    float d = 100.0;
    for (int i = 0; i < 5; i++) {
        d = min(d, body(i, p - vec3(1.2 * float(i - 2), 0.0, 0.0)));
    }
    return d;
}
