// Sobotka's AgX as Wrensch fits it by a polynomial of degree six, without a look: "Minimal AgX Implementation" (2023).
fn scene_film(linear: vec3f) -> vec3f {
    let into = mat3x3f(
        vec3f(0.842479062253094, 0.0423282422610123, 0.0423756549057051),
        vec3f(0.0784335999999992, 0.878468636469772, 0.0784336),
        vec3f(0.0792237451477643, 0.0791661274605434, 0.879142973793104),
    );
    let back = mat3x3f(
        vec3f(1.19687900512017, -0.0528968517574562, -0.0529716355144438),
        vec3f(-0.0980208811401368, 1.15190312990417, -0.0980434501171241),
        vec3f(-0.0990297440797205, -0.0989611768448433, 1.15107367264116),
    );
    // Stops that the curve covers.
    let least = -12.47393;
    let most = 4.026069;
    let x = clamp((log2(max(into * linear, vec3f(1e-10))) - least) / (most - least), vec3f(0.0), vec3f(1.0));
    let square = x * x;
    let fourth = square * square;
    let curved = 15.5 * fourth * square - 40.14 * fourth * x + 31.96 * fourth - 6.868 * square * x + 0.4298 * square + 0.1191 * x - 0.00232;
    // The curve ends in a screen's code of the power 2.2.
    return pow(clamp(back * curved, vec3f(1e-6), vec3f(1.0)), vec3f(2.2));
}
