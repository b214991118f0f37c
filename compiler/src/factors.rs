//! What a person may know of each factor: what it comes from, where it holds, what it costs, and what would lower it.

use crate::analysis::Box3;
use crate::analysis::search::{Search, Target};
use crate::certify::{Steepest, Truth};
use crate::compiled::Compiled;
use crate::live::Live;
use crate::diagnostic::{Code, Diagnostic};
use crate::functions::Functions;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Factor, Function, Graph, Node, NodeId, Proof, ShapeId};
use crate::rules::{Gives, RULES, Row};
use crate::source::{Sources, Span, written};
use rustc_hash::FxHashSet;
use std::rc::Rc;

/// Up to so many times the steps are few more.
const FEW: f64 = 1.5;
/// Factors within each other that multiply to more let no ray get anywhere.
const MOST_TOGETHER: f64 = 250.0;
/// Where nothing is known of how large a scene is, it is taken to be of this size.
const FAR_ENOUGH: f64 = 4.0;
/// Boxes of the search that tells what a rule gains.
const RULE_BOXES: usize = 192;
/// A rule that gains less is not named.
const GAINED: f64 = 1.005;
/// How many samples say how steep a formula is at most places.
const TYPICAL: usize = 33;

/// A parameter on which a factor depends.
#[derive(Clone, Debug, PartialEq)]
pub struct Ranged {
    /// Its name.
    pub name: String,
    /// The least and the greatest that the component on which the factor depends may be; of angles radians.
    pub range: [f64; 2],
    /// Whether it is shown in degrees.
    pub degrees: bool,
}

/// A factor, explained.
#[derive(Clone, Debug, PartialEq)]
pub struct Explained {
    /// Index into [`Graph::factors`].
    pub index: u32,
    /// How many factors stand around it in the bound: theirs multiply with its own.
    pub depth: usize,
    /// It and those around it, multiplied.
    pub product: f64,
    /// The factor for all values of the parameters.
    pub factor: f64,
    /// The factor for the parameters' defaults; never the larger.
    pub live: f64,
    /// How steep the formula is at most places: what is as steep everywhere takes no more steps for its factor. For a map of points 1: what
    /// is moved is a distance.
    pub typical: f64,
    /// Where rays go by more than the factor, which says little: how many times the steps that takes. See [`Functions::gentle`].
    pub gentle: Option<f64>,
    /// How it is known.
    pub proof: Proof,
    /// What it comes from: the name of what is called there, or `formula`.
    pub operation: String,
    /// The same as it is written, on one line.
    pub text: String,
    /// Where that stands.
    pub span: Span,
    /// Name of the text, line and column of its beginning (both from 1).
    pub place: (String, u32, u32),
    /// Where it holds, least and greatest corner in the space of what it comes from; none where it holds everywhere.
    pub region: Option<[[f64; 3]; 2]>,
    /// The closed form behind it, where there is one.
    pub form: Option<String>,
    /// The parameters on which it depends.
    pub parameters: Vec<Ranged>,
    /// The name of its field in the uniform block; none where the module does not read it.
    pub uniform: Option<String>,
    /// Why it is needed.
    pub reason: String,
    /// What would lower it.
    pub advice: String,
}

/// A scene in which one rule for factors acts alone: a line of `tests/corpus/rules.txt`.
#[derive(Clone, Debug, PartialEq)]
pub struct RuleScene {
    /// Its name.
    pub name: String,
    /// Why its factor is not attained; none where it is.
    pub loose: Option<String>,
    /// Half the side of the cube about the origin in which the steepest place is looked for.
    pub half: f64,
    /// The scene's text.
    pub text: String,
}

/// The rules in a text, one a line, of five parts; lines that begin with `#` are words. A line that is none of these is an error.
pub fn rules(text: &str) -> Result<Vec<RuleScene>, String> {
    let lines = text.lines().filter(|line| !line.is_empty() && !line.starts_with('#'));
    let rule = |line: &str| {
        let mut parts = line.splitn(5, ';').map(str::trim);
        let (name, near, half, kind, body) = (parts.next()?, parts.next()?, parts.next()?, parts.next()?, parts.next()?);
        let text = match kind {
            "shape" => format!("scene = {body}\n"),
            "number" => format!("field rule = {body}\nscene = rule\n"),
            _ => return None,
        };
        let loose = (near != "attained").then(|| near.to_owned());
        Some(RuleScene { name: name.to_owned(), loose, half: half.parse().ok()?, text })
    };
    lines.map(|line| rule(line).ok_or_else(|| format!("this is no rule: {line}"))).collect()
}

/// A factor beside what is true.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// The scene's factor, after a long search.
    pub factor: f64,
    /// How steep it is at the steepest place found: no factor may be smaller.
    pub attained: f64,
    /// What it is certified not to exceed, where that was asked.
    pub at_most: Option<f64>,
}

/// Judges the one factor of a rule's scene, by samples of what it was found from, and by the certified supremum, which may cost so many
/// boxes.
pub fn judge(compiled: &Compiled, half: f64, boxes: usize) -> Judged {
    let largest = compiled.summary.factor;
    let index = compiled.graph.factors.iter().position(|f| f.lipschitz == largest);
    let factor = index.map_or(largest, |i| compiled.tighten(i, 131_072));
    let sampled = index.map_or(0.0, |i| compiled.sampled_factor(i, 2048));
    let certified = certified(compiled, index, half, boxes);
    Judged {
        factor,
        attained: certified.map_or(sampled, |c| c.at_least.max(sampled)),
        at_most: certified.map(|c| c.at_most),
    }
}

/// The certified supremum of the slopes of what a factor was found from, where it was; of the scene's field without one. Where that is all
/// of space: in a cube about the origin, half its side being `half`. None for a map, for what holds only in a part of a box, and for what
/// reads more than the point.
pub fn certified(compiled: &Compiled, index: Option<usize>, half: f64, boxes: usize) -> Option<Steepest> {
    let cube = [Interval::new(-half, half); 3];
    let (graph, live) = (&compiled.graph, compiled.live());
    let field = graph.shape(compiled.root).map(|s| s.value)?;
    let (node, range) = match index {
        None => (field, cube),
        Some(index) => {
            let search = compiled.functions.searches.get(index)?.as_ref()?;
            let Target::Value(node) = search.target else { return None };
            let whole = search.domain.tube.is_none() && search.domain.within.is_empty() && search.parameters.is_empty();
            let alone = graph.reads(node).variables == 0;
            let point = search.domain.point;
            (whole && alone).then_some((node, if point.is_finite() { point.0 } else { cube }))?
        }
    };
    let truth = Truth::of(graph, &compiled.functions, node, &live, 1_000_000).ok()?;
    Some(truth.prover().steepest(range, 1.02, boxes))
}

/// Every factor of a scene, those that stand around others before them. `sources` are the texts that the scene was compiled from.
pub fn explain(compiled: &Compiled, sources: &Sources) -> Vec<Explained> {
    let mut live = compiled.live();
    compiled.follow(&mut live, Compiled::QUICK);
    let graph = &compiled.graph;
    let mut explained: Vec<Explained> = Vec::new();
    for (index, parent) in tree(graph, compiled.root, &compiled.functions) {
        let Some(factor) = graph.factors.get(index as usize) else { continue };
        let (depth, product) = parent.and_then(|p| explained.get(p)).map_or((0, 1.0), |p| (p.depth + 1, p.product));
        let one = one(compiled, sources, &live, index, factor);
        explained.push(Explained { depth, product: product * factor.lipschitz, ..one });
    }
    explained
}

/// The rules without which a factor would be larger, each with that larger factor. The rule that gains most comes first. A factor is infinite where
/// none would be known.
pub fn rules_of(compiled: &Compiled, index: u32) -> Vec<(&'static Row, f64)> {
    let Some(Some(search)) = compiled.functions.searches.get(index as usize) else { return Vec::new() };
    let found = |rules| Search { rules, ..search.clone() }.run(&compiled.graph, Rc::new([]), RULE_BOXES);
    let own = found(search.rules);
    let used = RULES.iter().filter(|row| row.gives != Gives::Region && row.gives != Gives::Bound && search.rules.has(row.rule));
    let mut gains: Vec<(&Row, f64)> = used.map(|row| (row, found(search.rules.without(row.rule)))).filter(|(_, without)| *without > GAINED * own).collect();
    gains.sort_by(|a, b| b.1.total_cmp(&a.1));
    gains
}

/// What is wrong where factors that stand within each other multiply to more steps than a ray has, though none of them is that large.
pub(crate) fn too_many_together(graph: &Graph, root: ShapeId, functions: &Functions) -> Option<Diagnostic> {
    let mut products: Vec<f64> = Vec::new();
    let mut worst: Option<(f64, &Factor)> = None;
    for (index, parent) in tree(graph, root, functions) {
        let factor = graph.factors.get(index as usize);
        let own = factor.map_or(1.0, |factor| factor.lipschitz.max(1.0));
        let around = parent.and_then(|p| products.get(p)).copied().unwrap_or(1.0);
        products.push(own * around);
        let is_by_both = own.max(around) <= MOST_TOGETHER && own * around > MOST_TOGETHER && !functions.gentle.contains_key(&index);
        if let (true, Some(factor)) = (is_by_both && worst.is_none_or(|(product, _)| own * around > product), factor) {
            worst = Some((own * around, factor));
        }
    }
    let (product, factor) = worst?;
    Some(Diagnostic::new(
        Code::Costly,
        factor.span,
        format!("the factors that stand around this multiply to ×{product:.0} with its own, which costs more steps than a ray has"),
        "let fewer of the maps that stand within each other stretch space, or let them stretch it less; `surefoot check --factors` shows each",
    ))
}

/// The factors in the bound of the scene, each once, with the place of the one that stands around it in the same list.
fn tree(graph: &Graph, root: ShapeId, functions: &Functions) -> Vec<(u32, Option<usize>)> {
    let bound = |shape| functions.formulas.get(&(shape, Function::Bound)).copied();
    let mut found: Vec<(u32, Option<usize>)> = Vec::new();
    let mut seen: FxHashSet<NodeId> = FxHashSet::default();
    let mut open: Vec<(NodeId, Option<usize>)> = bound(root).map(|b| (b, None)).into_iter().collect();
    while let Some((node, around)) = open.pop() {
        if !seen.insert(node) {
            continue;
        }
        let factor = |id: &NodeId| match graph.node(*id) {
            Node::Factor(index) => Some(*index),
            _ => None,
        };
        match graph.node(node) {
            Node::Op(Op::Mul, args) if args.iter().any(|a| factor(a).is_some()) => {
                let index = args.iter().find_map(factor).unwrap_or(0);
                if !found.iter().any(|(known, _)| *known == index) {
                    found.push((index, around));
                }
                let here = found.iter().position(|(known, _)| *known == index);
                open.extend(args.iter().filter(|a| factor(a).is_none()).map(|a| (*a, here)));
            }
            Node::Call(shape, Function::Bound, _) => open.extend(bound(*shape).map(|b| (b, around))),
            _ => open.extend(graph.arguments(node).iter().rev().map(|a| (*a, around))),
        }
    }
    found
}

fn one(compiled: &Compiled, sources: &Sources, live: &Live, index: u32, factor: &Factor) -> Explained {
    let (text, operation) = written(sources, factor.span);
    let (file, line, column) = sources.position(factor.span.file, factor.span.start);
    let search = compiled.functions.searches.get(index as usize).and_then(Option::as_ref);
    let region = search.map(|s| s.domain.point).filter(|b| b.0.iter().any(|i| i.is_finite()) && !b.is_empty());
    let corners = region.map(|b| [b.0.map(|i| i.lo), b.0.map(|i| i.hi)]);
    let mut explained = Explained {
        index,
        depth: 0,
        product: 1.0,
        factor: factor.lipschitz,
        live: live.factor(&compiled.graph, index),
        typical: search.filter(|s| matches!(s.target, Target::Value(_))).map_or(1.0, |s| about_the_scene(compiled, s).slope_near_zero(&compiled.graph, TYPICAL)),
        gentle: compiled.functions.gentle.get(&index).copied(),
        proof: factor.proof,
        form: form(sources, &operation, &text, factor.lipschitz, corners, search.and_then(|s| s.domain.tube)),
        operation,
        text,
        span: factor.span,
        place: (file.to_owned(), line, column),
        region: corners,
        parameters: search.map_or_else(Vec::new, |s| parameters(compiled, &s.parameters)),
        uniform: uniform(compiled, index),
        reason: factor.reason.clone(),
        advice: String::new(),
    };
    explained.advice = advice(&explained);
    explained
}

/// The same where the scene is: most of what holds everywhere is far from anything that is seen.
fn about_the_scene(compiled: &Compiled, search: &Search) -> Search {
    let size = compiled.functions.ahead.region.map_or(FAR_ENOUGH, |region| region.0.map(Interval::magnitude).into_iter().fold(0.0, f64::max));
    Search { domain: search.domain.at(search.domain.point.intersect(&Box3::cube(size))), ..search.clone() }
}

fn uniform(compiled: &Compiled, index: u32) -> Option<String> {
    let source = crate::interface::UniformSource::Factor(index);
    compiled.module.uniforms.iter().find(|u| u.source == source).map(|u| u.name.clone())
}

/// The parameters that have these components, and the range of the first of each that is among them.
fn parameters(compiled: &Compiled, components: &[u32]) -> Vec<Ranged> {
    let mut found: Vec<Ranged> = Vec::new();
    for &component in components {
        let Some(known) = compiled.graph.parameters.get(component as usize) else { continue };
        let holds = |p: &&crate::interface::Parameter| p.components().contains(&component);
        let Some(parameter) = compiled.parameters.iter().find(holds) else { continue };
        if !found.iter().any(|known| known.name == parameter.name) {
            found.push(Ranged { name: parameter.name.clone(), range: [known.min, known.max], degrees: parameter.degrees });
        }
    }
    found
}

/// How the factor of a known operation follows from its arguments.
fn form(
    sources: &Sources,
    operation: &str,
    text: &str,
    lipschitz: f64,
    region: Option<[[f64; 3]; 2]>,
    tube: Option<(usize, f64)>,
) -> Option<String> {
    // A turn that goes along with the place, or a shear: the identity and a rank-one term across it, whose norm t gives a largest
    // singular value of t/2 + √(1 + t²/4); so t is the factor less its reciprocal.
    let slide = lipschitz - 1.0 / lipschitz;
    match operation {
        "twist" => {
            let axis = match text.split(['(', ',']).nth(1).map(str::trim) {
                Some("x") => 0,
                Some("y") => 1,
                Some("z") => 2,
                _ => return Some(format!("rate times radius is {}", short(slide))),
            };
            let [low, high] = region?;
            let far = |i: usize| low.get(i).zip(high.get(i)).map_or(0.0, |(l, h)| l.abs().max(h.abs()));
            let corner = (0..3).filter(|i| *i != axis).map(|i| far(i).powi(2)).sum::<f64>().sqrt();
            let radius = tube.filter(|(about, _)| *about == axis).map_or(corner, |(_, radius)| radius);
            let known = radius > 0.0 && radius.is_finite();
            known.then(|| format!("rate {} over radius {}", short(slide / radius), short(radius)))
        }
        "shear" => Some(format!("rate {}", short(slide))),
        _ => claim(sources, operation).map(|claim| format!("at most {claim} by its closed form")),
    }
}

/// What the prelude claims of an operation, as it is written there.
fn claim(sources: &Sources, operation: &str) -> Option<String> {
    let prelude = sources.iter().filter(|(id, _)| crate::prelude::in_prelude(Span::new(*id, 0, 0)));
    for (_, file) in prelude {
        for kind in ["blend", "field", "field2"] {
            let Some(start) = file.text.find(&format!("\n{kind} {operation}(")) else { continue };
            let declaration = file.text.get(start + 1..)?;
            let head = declaration.split(" =").next()?;
            let claim = head.split(") lipschitz ").nth(1);
            return claim.filter(|c| !c.contains('{')).map(|c| c.split_whitespace().collect::<Vec<_>>().join(" "));
        }
    }
    None
}

/// What would lower a factor.
fn advice(known: &Explained) -> String {
    if known.proof == Proof::Measured {
        return "a region, `.within(box(…))`, a clamp of what grows, or divisors kept away from zero: then it can be proven".to_owned();
    }
    if known.live < 0.9 * known.factor && !known.parameters.is_empty() {
        let ranges: Vec<String> = known.parameters.iter().map(|parameter| format!("`{}`", parameter.name)).collect();
        return format!("a narrower range of {}", ranges.join(" or "));
    }
    let region = known.region.is_some();
    match known.operation.as_str() {
        "twist" | "bend" if region => "a smaller rate, or a narrower region: `.within(cylinder(…))` before it is moved",
        "twist" | "bend" | "shear" => "a smaller rate",
        "taper" => "less narrowing, or a clamp of what is narrowed to a smaller part",
        "scale" | "stretch" | "matrix" => "a stretch that is more alike along its axes",
        "sweep_helix" => "a smaller pitch, or a larger radius",
        "sweep" | "swept_twisted" => "less twist: narrow its range, or clamp it",
        "extrude_to" => "a greater height, or a larger `top`",
        "displace" => "a smaller amplitude or a lower frequency",
        name if name.contains("union") || name.contains("intersection") || name.contains("difference") => {
            "operands that are nearer to distances: the group is as steep as its steepest one"
        }
        "metaballs" | "mix" => "operands of less weight, or a narrower region with `.within(box(…))`",
        _ if region => "a narrower region with `.within(box(…))`, or a `clamp` of what is steep",
        _ => "smaller multiples, or a `clamp` of what is steep",
    }
    .to_owned()
}

impl Explained {
    /// `×1.62 from twist at column.sdf:12:31, rate 1 over radius 1`.
    pub fn headline(&self) -> String {
        let (file, line, column) = &self.place;
        let form = self.form.as_ref().map_or(String::new(), |f| format!(", {f}"));
        format!("{} from {} at {file}:{line}:{column}{form}", times(self.factor), self.operation)
    }

    /// How it is known and where: `derived within x -1..1, y -2..2, z -1..1`.
    pub fn knowledge(&self) -> String {
        let how = match self.proof {
            Proof::Measured => "unproven: measured at samples",
            other => other.name(),
        };
        match self.region {
            None => how.to_owned(),
            Some([low, high]) => {
                let sides = ["x", "y", "z"].iter().zip(low.iter().zip(high));
                let finite = sides.filter(|(_, (l, h))| l.is_finite() && h.is_finite());
                let sides: Vec<String> = finite.map(|(axis, (l, h))| format!("{axis} {}..{}", short(*l), short(h))).collect();
                format!("{how} within {}", sides.join(", "))
            }
        }
    }

    /// For which parameters it holds and how large it is now; empty where it depends on none. `now` says when that is.
    pub fn following(&self, now: &str) -> String {
        if self.parameters.is_empty() {
            return String::new();
        }
        let ranges: Vec<String> = self.parameters.iter().map(Ranged::written).collect();
        format!("{} for all {}; {} {now}", times(self.factor), ranges.join(", "), times(self.live))
    }

    /// What it costs: `about 1.6 times the steps near it`.
    pub fn cost(&self) -> String {
        let together = if self.depth > 0 { format!("; {} times with those around it", rough(self.product)) } else { String::new() };
        let cost = self.live / self.typical;
        let now = if self.live < 0.95 * self.factor { " as the sliders stand" } else { "" };
        match cost {
            _ if let Some(steps) = self.gentle => {
                let times = if steps < FEW { "few more steps".to_owned() } else { format!("about {} times the steps", rough(steps)) };
                format!("{times}: near its surface rays go by how steep it is there{together}")
            }
            _ if self.live <= 1.0 => format!("no more steps: the formula is flatter than a distance{now}{together}"),
            _ if cost < 1.05 && self.live > 1.5 => format!("no more steps: the formula is as steep nearly everywhere{together}"),
            _ if cost < 1.05 => format!("hardly more steps near it{now}{together}"),
            _ => format!("about {} times the steps near it{now}{together}", rough(cost)),
        }
    }
}

impl Ranged {
    /// As one writes it: `turn in 0deg..90deg`.
    fn written(&self) -> String {
        let end = |x: f64| if self.degrees { format!("{}deg", short(x.to_degrees())) } else { short(x) };
        format!("{} in {}..{}", self.name, end(self.range[0]), end(self.range[1]))
    }
}

/// `×1.62`; `×1.0014` near one.
fn times(factor: f64) -> String {
    if (factor - 1.0).abs() < 0.01 { format!("×{factor:.4}") } else { format!("×{}", short(factor)) }
}

/// Three digits that count, and of what is small two.
fn short(value: f64) -> String {
    let digits = match value.abs() {
        a if a >= 100.0 => 0,
        a if a >= 10.0 => 1,
        a if !(1e-12..0.1).contains(&a) => 2,
        a => (1.0 - a.log10().floor()) as usize,
    };
    let text = format!("{value:.digits$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// Two digits that count.
fn rough(value: f64) -> String {
    if value < 10.0 { format!("{value:.1}") } else { format!("{value:.0}") }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
mod tests {
    use super::*;
    use crate::{MemoryLoader, Options, Outcome, compile};

    fn outcome(text: &str) -> Outcome {
        compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default())
    }

    fn explained(text: &str) -> Vec<Explained> {
        let outcome = outcome(text);
        let compiled = outcome.compiled.unwrap();
        explain(&compiled, &outcome.sources)
    }

    #[test]
    fn a_twist_says_its_rate_and_radius() {
        let found = explained("param rate = 0.5 in 0..2 \"how far\"\nscene = box((1, 2, 1)).twist(y, rate)\n");
        let [twist] = found.as_slice() else { panic!("{found:?}") };
        assert_eq!((twist.operation.as_str(), twist.text.as_str()), ("twist", "twist(y, rate)"));
        assert_eq!(twist.place, ("main.sdf".to_owned(), 2, 24));
        assert_eq!(twist.proof, Proof::Derived);
        assert_eq!(twist.parameters, [Ranged { name: "rate".to_owned(), range: [0.0, 2.0], degrees: false }]);
        assert!(twist.live < 0.75 * twist.factor, "{twist:?}");
        // From the factor and the region's corner comes out again the largest rate of the range, up to what the search adds.
        let form = twist.form.as_ref().unwrap();
        let rate: f64 = form.split_whitespace().nth(1).unwrap().parse().unwrap();
        assert!((2.0..2.2).contains(&rate) && form.contains(" over radius "), "{form}");
        assert!(twist.advice.contains("`rate`") && twist.uniform.is_some());
    }

    #[test]
    fn factors_within_factors_multiply() {
        let found = explained("scene = box((1, 2, 1)).twist(y, 1).within(cylinder(0.8, 2)).bend(z, y, 0.3).within(box(3))\n");
        let depths: Vec<_> = found.iter().map(|f| (f.operation.as_str(), f.depth)).collect();
        assert_eq!(depths, [("bend", 0), ("twist", 1)]);
        assert!((found[1].product - found[0].factor * found[1].factor).abs() < 1e-12);
    }

    #[test]
    fn what_is_as_steep_everywhere_costs_nothing() {
        let costs = |text: &str| explained(text).first().map(Explained::cost).unwrap();
        let ten = costs("field f = 10 * (length(p) - 1)\nscene = f\n");
        assert!(ten.starts_with("no more steps: the formula is as steep"), "{ten}");
        let waves = costs("field f = length(p) - 1 + 0.3 * sin(9 * p.x)\nscene = f\n");
        assert!(waves.starts_with("about "), "{waves}");
        assert_eq!((times(0.0012345), times(12.345)), ("×0.0012".to_owned(), "×12.3".to_owned()));
    }

    #[test]
    fn a_measured_factor_says_that_it_is_unproven() {
        let found = explained("field f = 1 / p.x - 2\nscene = f\n");
        let [f] = found.as_slice() else { panic!("{found:?}") };
        assert_eq!(f.proof, Proof::Measured);
        assert!(f.knowledge().contains("unproven") && f.advice.contains("within"));
        assert!(explained("scene = sphere(1)\n").is_empty());
    }
}
