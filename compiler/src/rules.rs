//! The table of rules that make bounds tighter. A row has a rule's name, what it does, its source, and a scene that needs it.
//!
//! Every bound is safe without any rule, but rays need more steps. So each rule can be switched off (`--without-rule ID`), and `docs/rules.md`
//! says what each gains. The searches themselves, and the walk back from a value to the coordinates, are not rules.

/// When a rule is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Cost {
    /// It is seen in the formula, once: the same for every box.
    Once,
    /// It adds some steps to each box of a search.
    Box,
    /// It is a search of its own.
    Search,
}

impl Cost {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Cost::Once => "once",
            Cost::Box => "each box",
            Cost::Search => "a search",
        }
    }
}

/// What a rule gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Gives {
    /// A smaller range of values.
    Range,
    /// A smaller Lipschitz constant.
    Constant,
    /// That a formula is continuous, or by how much it jumps.
    Continuity,
    /// A smaller box about the solid.
    Region,
    /// A longer step from the same constants.
    Bound,
}

impl Gives {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Gives::Range => "range",
            Gives::Constant => "constant",
            Gives::Continuity => "continuity",
            Gives::Region => "region",
            Gives::Bound => "bound",
        }
    }
}

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// The rule.
    pub rule: Rule,
    /// Its name on the command line.
    pub id: &'static str,
    /// What it gives.
    pub gives: Gives,
    /// When it is tried.
    pub cost: Cost,
    /// The file in `compiler/src` that holds it.
    pub file: &'static str,
    /// What it matches, and what follows.
    pub what: &'static str,
    /// Its source in the literature, or its proof.
    pub source: &'static str,
    /// A scene that it makes cheaper: rays take more steps without it, a factor grows, or a box does.
    pub scene: &'static str,
}

macro_rules! rules {
    ($($rule:ident $id:literal $gives:ident $cost:ident $file:literal
        what $what:literal source $source:literal scene $scene:literal)*) => {
        /// The name of a rule.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Rule {
            $(#[doc = $what] $rule,)*
        }

        /// The table.
        pub const RULES: &[Row] = &[
            $(Row { rule: Rule::$rule, id: $id, gives: Gives::$gives, cost: Cost::$cost, file: $file, what: $what, source: $source, scene: $scene },)*
        ];
    };
}

// A set has a bit for each rule.
const _: () = assert!(RULES.len() <= u64::BITS as usize);

/// Rules that may be used: all of them by default.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct RuleSet(u64);

impl Default for RuleSet {
    fn default() -> Self {
        Self(u64::MAX)
    }
}

impl RuleSet {
    /// Whether a rule may be used.
    pub fn has(self, rule: Rule) -> bool {
        self.0 >> (rule as u32) & 1 == 1
    }

    /// The same set without a rule.
    #[must_use]
    pub fn without(self, rule: Rule) -> Self {
        Self(self.0 & !(1 << (rule as u32)))
    }
}

impl Row {
    /// The row of a rule of this name.
    pub fn named(id: &str) -> Option<&'static Row> {
        RULES.iter().find(|row| row.id == id)
    }
}

rules! {
    Claims "claims" Constant Box "analysis/rules/claims.rs"
        what "The prelude says of a formula how steep it is, and within which range it stays."
        source "Stated beside each formula; `compiler/tests/ranges.rs` and `compiler/tests/sound.rs` hold it against samples."
        scene "scene = sphere(1).displace(0.1 * fbm(3 * p))"
    Branches "branches" Constant Search "analysis/branches.rs"
        what "Where a box straddles a kink, each side is searched by itself. Sides that exclude each other vanish."
        source "The constant of a continuous piecewise formula is the largest of its pieces'."
        scene "field f = { let q = abs(p - (0.1, 0.2, 0.3)) - 1; length(max(q, 0)) + min(max(q.x, max(q.y, q.z)), 0) }\nscene = f"
    Mirror "mirror" Constant Once "analysis/formula.rs"
        what "A coordinate that one `abs` alone reads is searched on one side of its plane."
        source "The other side is its mirror image."
        scene "field f = { let q = abs(p) - 1; length(max(q, 0)) + min(max(q.x, max(q.y, q.z)), 0) }\nscene = f"
    JacobianNorm "jacobian-norm" Constant Box "analysis/rules/jacobian_norm.rs"
        what "The norm of a map of points is that of its Jacobian, not of its rows by themselves."
        source "Spectral norm of an interval matrix; bounds in `analysis/matrix.rs`."
        scene "scene = sphere(0.6).matrix(mat3((1, 0.5, 0), (0, 1, 0.25), (0, 0, 0.8)))"
    TurnedPair "turned-pair" Constant Box "analysis/rules/jacobian_norm.rs"
        what "Two coordinates that are two others turned by an angle count as those two, with the slip of the angle."
        source "A turn is an isometry; its derivative by the angle is the turned point at a right angle."
        scene "field f = box((1, 2, 0.2)).at(rotate(p, y, 0.5 * p.x))\nscene = f.within(box(4))"
    MirroredPoint "mirrored-point" Constant Box "analysis/rules/isometry.rs"
        what "A point that is mirrored in a plane, wherever it stands, counts as the point before."
        source "A reflection is an isometry."
        scene "param tilt = 0.5 in -2..2\nlet n = normalize((tilt, 0.3, -1))\nfield f = box(1, 0.6, 0.3).at(p - 2 * min(0, dot(p, n)) * n)\nscene = f"
    IsometryChain "isometry-chain" Constant Once "analysis/rules/isometry_chain.rs"
        what "What is folded, turned and moved again and again is followed from step to step."
        source "The norm of a product is at most the product of the norms; each step between two cuts of three coordinates has norm one."
        scene "param t = 0.5 in 0..1\nfield f = { let q = p for i in 0..8 { q = rotate(rotate(abs(q) - 0.5, z, t), x, t / 2) }; box(0.4).at(q) }\nscene = f"
    Soft "soft" Constant Once "analysis/rules/soft.rs"
        what "A soft minimum, a logarithm of a sum of powers of e or a norm of a higher power is as steep as its steepest part."
        source "Its weights are not negative and add up to one (Boyd and Vandenberghe 2004, 3.1.5)."
        scene "field f = -log(exp(-8 * p.x) + exp(-8 * p.y) + exp(-8 * (length(p) - 1))) / 8\nscene = f.within(box(4))"
    HigherNorm "higher-norm" Constant Box "analysis/derivative.rs"
        what "A root of a length of squares, which is a norm of the fourth power, is no steeper than the length."
        source "Norms of a higher power are less: the dual norm of the gradient is at most one."
        scene "field f = sqrt(length((p.x * p.x, p.y * p.y, p.z * p.z))) - 1\nscene = f"
    FractionalPart "fractional-part" Range Once "analysis/rules/algebraic_enclosures.rs"
        what "`x - floor(x)` and the rest of a division lie between zero and the divisor."
        source "By the definition of the floor."
        scene "fn mirrored(x: float, s: float) = { let c = floor(x / s + 0.5); (x - s * c) * (mod(c, 2) * 2 - 1) }\nfield posts = length((mirrored(p.x, 2), p.y, mirrored(p.z, 2)) - (-0.4, 0.4, -0.4)) - 0.4\nscene = posts.within(box(7))"
    Mean "mean" Range Once "analysis/rules/algebraic_enclosures.rs"
        what "`a (1 - t) + b t` with t between zero and one lies between a and b, and is as steep as they are and as t times their difference."
        source "A convex combination."
        scene "field f = mix(length(p) - 1, length(p) - 1.2, saturate(0.3 + length(p.xz))) \nscene = f.within(box(4))"
    Bernstein "bernstein" Range Once "analysis/rules/algebraic_enclosures.rs"
        what "A polynomial of one number lies between its least and greatest Bernstein coefficient, and so does its slope."
        source "Lane and Riesenfeld 1981."
        scene "field f = { let t = clamp(p.x, 0, 1); p.y - t * t * (3 - 2 * t) }\nscene = f.within(box(4))"
    NormalizedVector "normalized-vector" Constant Once "analysis/rules/normalized_vector.rs"
        what "A coordinate over the length of its vector is at most one, and as steep as one over that length."
        source "The derivative of p/|p| is the projection across p, over |p|."
        scene "field f = length(p) - 1 - 0.1 * p.x / length(p)\nscene = f.within(box(4))"
    PolarRotation "polar-rotation" Constant Once "analysis/rules/polar_rotation.rs"
        what "A point that is turned by way of its own length and angle keeps lengths."
        source "(r cos(φ + t), r sin(φ + t)) is the point turned by t."
        scene "param turn = 1 in 0..2\nfield f = { let a = atan(p.z, p.x); let r = length(p.xz); let b = a + turn * p.y; length((r * cos(b), p.y, r * sin(b)) - (1, 0, 0)) - 0.35 }\nscene = f.within(box(4))"
    Multilinear "multilinear" Range Once "analysis/rules/multilinear.rs"
        what "A sum of products in which no number is multiplied by itself takes its ends at the corners of the box."
        source "It is linear in each number by itself."
        scene "fn noise(v: vec2) = { let i = floor(v); let f = fract(v); let u = f * f * (3 - 2 * f); let a = hash(i); let b = hash(i + (1, 0)); let c = hash(i + (0, 1)); let d = hash(i + (1, 1)); a + (b - a) * u.x + (c - a) * u.y + (a - b - c + d) * u.x * u.y }\nfield land = p.y - noise(p.xz)\nscene = land.within(box(6))"
    ContinuousSelect "continuous-select" Continuity Once "analysis/rules/continuous_select.rs"
        what "A choice whose sides are the same where it changes over kinks there and does not jump."
        source "x - y is a multiple of a - b in `if a < b { x } else { y }`."
        scene "field f = { let x = if p.x < p.y { 2 * p.y - p.x } else { p.x }; length((x - 1, p.y, p.z)) - 0.5 }\nscene = f"
    AnglePeriodicity "angle-periodicity" Continuity Box "analysis/rules/angle_periodicity.rs"
        what "What turns by whole turns under a sine does not jump where the angle does."
        source "sin(t + 2πn) = sin(t)."
        scene "field flower = { let t = atan(p.z, p.x); let r = pow(pow(abs(cos(t)), 3) + pow(abs(sin(t)), 3), -0.5); max(length(p.xz) - 0.6 * r, abs(p.y) - 0.3) }\nscene = flower.within(box(3, 1, 3) - cylinder(0.2, 2))"
    UnsignedAngle "unsigned-angle" Continuity Box "analysis/derivative.rs"
        what "The angle of something that is never below zero does not cross its cut."
        source "`atan2(y, x)` jumps where y changes its sign and x is negative."
        scene "field f = length(p) - 1 - 0.05 * atan(abs(p.z), p.x)\nscene = f.within(box(3))"
    MeetsAtWalls "meets-at-walls" Continuity Search "functions/jump_magnitude.rs"
        what "A minimum over neighbouring cells is continuous where the cells that change at a wall are never the nearest."
        source "What two sides of a wall have in common cancels; intervals of the rest."
        scene "field strewn = { let n = floor(p.xz); for i in -1..2 by min { for j in -1..2 by min { let o = hash3(n + (i, j)); length(p - (n.x + i + 0.3 + 0.4 * o.x, 0, n.y + j + 0.3 + 0.4 * o.y)) - 0.1 } } }\nscene = strewn.within(box(3))"
    RotatedDistance "rotated-distance" Constant Box "analysis/rules/rotated_distance.rs"
        what "A distance at a point that is turned by a varying angle is no steeper far away than its solid reaches."
        source "Turning the point is turning its nearest point back: at most R dt."
        scene "scene = chamfer_union(sphere(0.8).twist(y, 2), box(1, 2, 0.6).translate(0.7, 0, 0).stretch((1, 0.5, 2)), 0.3)"
    Parts "parts" Constant Search "analysis/constant.rs"
        what "A multiple of a formula, or a sum with a number, is searched as the formula is; a sum over all of space term by term."
        source "Lipschitz constants of sums add up."
        scene "field web(f: float) = dot(sin(f * p), cos(f * p.zxy)) / f\nscene = web(3).shell(0.1) & sphere(1.2)"
    SumTerms "sum-terms" Constant Search "analysis/rules/sum_terms.rs"
        what "Each term of a sum is searched by itself first; a term that is flat over a box is left out there."
        source "No term is steeper than it is anywhere."
        scene "field f = 0.5 - exp(-dot(p, p)) - exp(-dot(p - 1.2, p - 1.2))\nscene = f.within(box(6))"
    Radial "radial" Constant Search "analysis/rules/radial.rs"
        what "A formula of one distance is searched along that number alone."
        source "The chain rule: |∇f(d)| = |f'(d)| |∇d|."
        scene "field f = 0.5 - exp(-4 * dot(p, p))\nscene = f.within(box(6))"
    Polar "polar" Constant Search "analysis/rules/polar.rs"
        what "A formula of an angle or of a distance from an axis is searched in distance and angle, or in a plane through the axis."
        source "|∇f|² = f_r² + (f_φ / r)² + f_z²."
        scene "field f = length(p.xz) - 1 - 0.06 * cos(12 * atan(p.z, p.x))\nscene = f.within(box(3))"
    Period "period" Constant Once "analysis/rules/period.rs"
        what "What repeats is searched over one period in place of all of space."
        source "A gradient that repeats takes all its values in one period."
        scene "field web(f: float) = dot(sin(f * p), cos(f * p.zxy)) / f\nscene = web(3).shell(0.1) & sphere(1.2)"
    NoiseCells "noise-cells" Constant Search "analysis/rules/noise_cells.rs"
        what "A longer search of what noise warps goes cell by cell, in which noise is a polynomial."
        source "Bernstein coefficients bound a polynomial over a box (Garloff 1986)."
        scene "warp wander = p + (0, 0.15 * perlin(1.5 * p.xz) + 0.02 * p.x * p.y, 0.1 * perlin(2 * p) * p.x)\nscene = sphere(1).wander()"
    Twist "twist" Constant Once "analysis/constant.rs"
        what "A turn about an axis by an angle that goes along with it has a constant in closed form, within a tube."
        source "The largest singular value of a shear by a: a/2 + √(1 + a²/4)."
        scene "scene = (box((1, 2, 0.2)) - sphere(0.3)).twist(y, 1.5)"
    BlendSublevelSet "blend-sublevel-set" Region Box "analysis/rules/blend_sublevel_set.rs"
        what "A blend of two fields is above a level where both are above another, which is found from the blend's formula."
        source "By intervals of the formula, the level found by halving."
        scene "shape letter = round_union(rectangle((1.6, 0.4)), rectangle((0.4, 1.6)).translate(-0.6, 0.6), rectangle((0.4, 1)).translate(0.6, 0.3), 0.2).extrude(0.5)\nscene = smooth_union(letter, box((1.6, 0.3, 0.5)).translate(0, 1.2, 0), 0.25).twist(y, 0.4)"
    Polytope "polytope" Region Search "analysis/rules/polytope.rs"
        what "The box of what several linear formulas leave over."
        source "Weak duality of linear programs (Chvátal 1983)."
        scene "field f = max(max(p.x + p.y, p.x - p.y), max(max(-p.x + p.z, -p.x - p.z), max(p.y - p.x, 0 - p.x - p.y))) - 1\nscene = f"
    Mix "mix" Region Box "analysis/hc4_projections.rs"
        what "A mean of two is at most a level where one of them is."
        source "A convex combination is no less than the least."
        scene "param t = 0.5 in 0..1\nfield f = mix(length(p) - 1, length(p - (1, 0, 0)) - 0.5, t)\nscene = f"
    TurnedPoint "turned-point" Region Box "analysis/hc4_projections.rs"
        what "A turned point is as far from the axis as it was before."
        source "A turn keeps lengths."
        scene "field f = { let q = turn(p.xz, 3 * p.y); max(max(abs(q.x), abs(q.y)) - 1, abs(p.y) - 2) }\nscene = f"
    CappedSum "capped-sum" Region Box "analysis/hc4_projections.rs"
        what "A sum with a minimum of a number in it is looked at on both sides of the kink."
        source "The region of a union of cases is the hull of theirs."
        scene "field f = length(max(abs(p) - 1, 0)) + min(max(abs(p.x) - 1, max(abs(p.y) - 1, abs(p.z) - 1)), 0)\nscene = f"
    Sift "sift" Region Search "analysis/region.rs"
        what "Parts are dropped in which the value at the middle is more than the constant times the way to the corners."
        source "The definition of a Lipschitz constant."
        scene "field f = p.x * p.x + 4 * p.y * p.y + p.x * p.y + p.z * p.z - 1\nscene = f.within(box(20))"
    Shave "shave" Region Search "analysis/region.rs"
        what "Slabs at the faces of a box are cut off where the formula is above the level everywhere."
        source "Interval arithmetic."
        scene "field f = p.x * p.x + 4 * p.y * p.y + p.x * p.y + p.z * p.z - 1\nscene = f"
    Tube "tube" Region Once "functions/domains.rs"
        what "The solid of what turns about an axis stays within a tube about it."
        source "A turn keeps the distance from its axis."
        scene "scene = box((1, 2, 0.2)).twist(y, 3)"
    Cut "cut" Region Search "functions/domains.rs"
        what "In an intersection a steep operand need only hold where the other one is at most a level."
        source "Elsewhere the other operand is the larger."
        scene "field tangle() = { let q = p * p; dot(q, q) - 5 * (q.x + q.y + q.z) + 11.8 }\nscene = tangle().within(box(5))"
    Absorbed "absorbed" Bound Search "functions/domains.rs"
        what "An operand of an intersection that is negative all over the other's solid is left out."
        source "max(a, b) = a on the surface where b < 0 there."
        scene "scene = sphere(1) - box(1).translate(5, 0, 0)"
    Zones "zones" Bound Search "functions/zones.rs"
        what "A map that stretches more the farther out has bounds in zones about the origin."
        source "Within a zone its own constant holds; the way out of it is a bound as well."
        scene "scene = sphere(0.3).repeat(1).bend(z, x, 0.2)"
    CappedLevel "capped-level" Bound Search "functions/capped.rs"
        what "A formula that is steep only far from zero is cut off at a level."
        source "min(max(f, -v), v) has the same surface."
        scene "field f = 1 - 1 / dot(p, p)\nscene = f.within(box(4))"
    Curvature "curvature" Bound Search "functions/level_and_curvature_bounds.rs"
        what "Where the gradient changes slowly, the value and the gradient at a point say how far the surface is at least."
        source "Taylor: f changes by at most |∇f| t + c t²/2."
        scene "field f = { let q = dot(p, p); (q - 1) * (q * q * q + 2) }\nscene = f.within(box(6))"
    Levels "levels" Bound Search "functions/level_and_curvature_bounds.rs"
        what "A formula that is gentle near its surface has a constant for each of some levels."
        source "On the way to the surface every level between is passed."
        scene "field f = { let a = length(p) - 1; a * (1 + a * a * a * a * (20 + abs(p.x))) }\nscene = f.within(box(6))"
    Convex "convex" Bound Search "functions/convex.rs"
        what "A convex formula that is flatter than a distance is divided by its gradient."
        source "A convex function lies above its tangent plane (Boyd and Vandenberghe 2004, 3.1.3)."
        scene "scene = ellipsoid((2, 0.5, 1))"
    SmoothUnionOperands "smooth-union-operands" Bound Search "functions/smooth_union_bound.rs"
        what "A smooth union is bound by each operand over its own factor, and by the blend where both are near."
        source "It differs from the lesser only within the radius."
        scene "field puff = exp(2.5 * (length(p - (0.5, 0.9, 0.84)) - 0.8)) - 1\nscene = puff.smooth_union(sphere(0.45), 0.1)"
    GroupBounds "group-bounds" Bound Once "functions/groups.rs"
        what "A group that grows with its shapes and has their signs is made of their bounds."
        source "Stated in its documentation (`Bounds: s`)."
        scene "field2 wavy = { let r = length(p); r - 0.12 - 0.03 * cos(5 * atan(p.y, p.x)) }\nscene = wavy.sweep_helix(1, 0.6, 3)"
    OneCell "one-cell" Constant Search "functions/cell.rs"
        what "What goes by cells is searched in one of them, with a free number for what is the same all over it."
        source "Every cell is one of these."
        scene "field hills = { let n = floor(p.xz); let heights = for i in -1..2 by + { for j in -1..2 by + { let cell = n + (i, j); let o = hash3(cell); 0.3 * o.z * exp(-8 * dot(p.xz - cell - o.xy, p.xz - cell - o.xy)) } }; p.y - heights }\nscene = hills.within(box(6))"
    Counts "counts" Constant Search "functions/counts.rs"
        what "A loop to a live end is searched count by count."
        source "The count is one of these."
        scene "param turns: int = 3 in 1..8\nfield f = { let q = p, s = 1 for i in 0..turns { q = 2 * abs(q) - 1, s = 2 * s }; (length(q) - 1) / s }\nscene = f"
    JumpHeight "jump-height" Continuity Search "functions/seams.rs"
        what "Each side of a wall is written anew, and how far the two can be apart is how high the formula jumps."
        source "At the wall of a cell its number is one of two."
        scene "field2 gear() = { let a = 1turn / 7; let q = turn(p, a * round(atan2(p.x, p.y) / a)); max(length(p) - 1.2, -(abs(q.x) - 0.1 * (1.3 - q.y))) }\nscene = (gear() | circle(1)).extrude(0.4)"
    Staircase "staircase" Bound Search "functions/staircase_relaxation.rs"
        what "Far from stairs a ray goes over all of them, as from walls that are not high."
        source "f changes by at most its slope times the way and the height of what jumps on it."
        scene "field f = p.y - 0.1 * floor(4 * p.x)\nscene = f.within(box(4))"
    FarSides "far-sides" Bound Search "functions/sides.rs"
        what "Where both sides of the nearest jump are far, a ray passes it."
        source "Up to the second jump the formula is one of the two."
        scene "field f = { let c = round(p.x); length(p - (c, 0, 0)) - 0.2 - 0.1 * hash(c) }\nscene = f.within(box(6))"
    Agreement "agreement" Continuity Search "functions/agree.rs"
        what "Both sides of a jump are compared at thousands of places; if they agree everywhere, rays pass, and the scene is called unproven."
        source "A measurement, not a proof."
        scene "field f = { let r = (1, 1.7320508); let a = mod(p.xz, r) - r / 2; let b = mod(p.xz - r / 2, r) - r / 2; let g = if dot(a, a) < dot(b, b) { a } else { b }; length((length(g) - 0.3, p.y)) - 0.1 }\nscene = f.within(box((12, 3, 12)))"
}
