//! What is read, what is said of what can't be, and how it is laid out.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]

mod formatting;
mod random;

use super::ast::*;
use super::parse;
use super::parser::MAX_NESTING;
use crate::diagnostic::{Code, Diagnostic, render};
use crate::source::{FileId, Sources};

const CONTRACT: &str = include_str!("../../../../tests/corpus/right/contract.sdf");

fn read(text: &str) -> File {
    let (file, diagnostics) = parse(FileId(0), text);
    assert!(diagnostics.is_empty(), "{}", shown(text, &diagnostics));
    file
}

fn shown(text: &str, diagnostics: &[Diagnostic]) -> String {
    let mut sources = Sources::default();
    sources.add("test.sdf", text);
    render(&sources, diagnostics, false)
}

fn codes(text: &str) -> Vec<Code> {
    parse(FileId(0), text).1.iter().map(|d| d.code).collect()
}

/// The value of the only declaration of a text, with brackets around every node.
fn value(text: &str) -> String {
    let file = read(&format!("let v = {text}"));
    let [Item { kind: ItemKind::Let(Let { bindings, .. }), .. }] = &file.items[..] else {
        panic!("{file:?}")
    };
    bracketed(&bindings[0].1)
}

fn all(items: &[Expr]) -> String {
    items.iter().map(bracketed).collect::<Vec<_>>().join(" ")
}

fn arguments(items: &[Argument]) -> String {
    let each = items.iter().map(|a| match &a.name {
        Some(name) => format!("{}:{}", name.text, bracketed(&a.value)),
        None => bracketed(&a.value),
    });
    each.collect::<Vec<_>>().join(" ")
}

fn bracketed(e: &Expr) -> String {
    match &e.kind {
        ExprKind::Hole => "?".into(),
        ExprKind::Bool(b) => b.to_string(),
        ExprKind::Int(i) => i.to_string(),
        ExprKind::Float(f) => format!("{f:?}"),
        ExprKind::Angle(a, unit) => format!("{a}{unit:?}"),
        ExprKind::Length(a, unit) => format!("{a}{unit:?}"),
        ExprKind::Color(c) => format!("{c:?}"),
        ExprKind::Str(s) => format!("{s:?}"),
        ExprKind::Name(n) => n.clone(),
        ExprKind::Vector(v) => format!("<{}>", all(v)),
        ExprKind::Paren(v) => bracketed(v),
        ExprKind::List(v) => format!("[{}]", all(v)),
        ExprKind::Unary(op, v) => format!("({op:?} {})", bracketed(v)),
        ExprKind::Chain(first, rest) => {
            let rest: String =
                rest.iter().map(|(op, _, e)| format!(" {op:?} {}", bracketed(e))).collect();
            format!("({}{rest})", bracketed(first))
        }
        ExprKind::Call(f, a) => format!("{}({})", bracketed(f), arguments(a)),
        ExprKind::Dot(v, n, None) => format!("{}.{}", bracketed(v), n.text),
        ExprKind::Dot(v, n, Some(a)) => format!("{}.{}({})", bracketed(v), n.text, arguments(a)),
        ExprKind::Index(v, i) => format!("{}[{}]", bracketed(v), bracketed(i)),
        ExprKind::For(f) => {
            let by = match f.by.as_ref().map(|by| &by.kind) {
                None => String::new(),
                Some(FoldKind::Operator(op)) => format!(" by {op:?}"),
                Some(FoldKind::Call(f, a)) => format!(" by {}({})", bracketed(f), arguments(a)),
            };
            format!("(for {} in {}{by} {})", f.index.text, bracketed(&f.source), bracketed(&f.body))
        }
        ExprKind::If(c, a, b) => {
            let b = b.as_ref().map_or(String::new(), |b| format!(" else {}", bracketed(b)));
            format!("(if {} {}{b})", bracketed(c), bracketed(a))
        }
        ExprKind::Block(lets, v) => {
            let lets: String = lets.iter().map(|l| format!("{}; ", bracketed_let(l))).collect();
            format!("{{{lets}{}}}", bracketed(v))
        }
        ExprKind::Range(a, b) => format!("({}..{})", bracketed(a), bracketed(b)),
    }
}

fn bracketed_let(l: &Let) -> String {
    let each = |b: &[(Name, Expr)]| {
        b.iter().map(|(n, e)| format!("{}={}", n.text, bracketed(e))).collect::<Vec<_>>().join(",")
    };
    let iterate = l.iterate.as_ref().map_or(String::new(), |i| {
        let condition =
            i.condition.as_ref().map_or(String::new(), |c| format!(" while {}", bracketed(c)));
        let lets: String = i.lets.iter().map(|l| format!("{}; ", bracketed_let(l))).collect();
        format!(
            " for {} in {}{condition} {{{lets}{}}}",
            i.index.text,
            bracketed(&i.source),
            each(&i.updates)
        )
    });
    format!("let {}{iterate}", each(&l.bindings))
}

#[test]
fn the_contract_parses() {
    let file = read(CONTRACT);
    assert_eq!(file.items.len(), 25);
    assert_eq!(
        file.items[5].doc.as_deref(),
        Some(
            "A primitive from a formula, negative inside. The compiler derives how far a ray may step."
        )
    );
}

#[test]
fn numbers() {
    assert_eq!(
        value("[6, 0.5, 1e-3, 1.5E+2, 45deg, 0.5turn, 1turn, 0.1rad]"),
        "[6 0.5 0.001 150.0 45Deg 0.5Turn 1Turn 0.1Rad]"
    );
    assert_eq!(value("[.5, -.25, 1., 2.*3., .5turn, 1 -.5]"), "[0.5 (Neg 0.25) 1.0 (2.0 Mul 3.0) 0.5Turn (1 Sub 0.5)]");
    assert_eq!(value("[for i in .5..1. { i }]"), "[(for i in (0.5..1.0) {i})]");
    assert_eq!(value("[for i in 0..2 { i }]"), "[(for i in (0..2) {i})]");
    assert_eq!(value("[for i in 0.02..0.06 { i }]"), "[(for i in (0.02..0.06) {i})]");
    assert_eq!(value("2.max(3)"), "2.max(3)");
    assert_eq!(value("[#fff, #d4af37]"), "[[255, 255, 255] [212, 175, 55]]");
}

#[test]
fn precedence() {
    assert_eq!(
        value("-a.b[1] * c % d & e + f - g | h < i && j || k"),
        "((((((((Neg a.b[1]) Mul c Rem d) Intersect e) Add f Sub g) Union h) Lt i) And j) Or k)"
    );
    assert_eq!(
        value("a || b && c == d | e + f & g * -h"),
        "(a Or (b And (c Eq (d Union (e Add (f Intersect (g Mul (Neg h))))))))"
    );
    assert_eq!(value("a - b * c - d"), "(a Sub (b Mul c) Sub d)");
    assert_eq!(value("!-!a"), "(Not (Neg (Not a)))");
    assert_eq!(value("-2.max(3)"), "(Neg 2.max(3))");
    assert_eq!(value("a | b - c | d & e"), "(a Union (b Sub c) Union (d Intersect e))");
}

#[test]
fn loops_choices_and_blocks() {
    assert_eq!(
        value("for i in 0..n by smooth_union(0.03) { s }.round(2) | b"),
        "((for i in (0..n) by smooth_union(0.03) {s}).round(2) Union b)"
    );
    assert_eq!(value("for a in atoms by + { a }"), "(for a in atoms by Add {a})");
    assert_eq!(value("for by in by by min { by }"), "(for by in by by min() {by})");
    assert_eq!(
        value("if a < b { c } else if d { e } else { f }.x"),
        "(if (a Lt b) {c} else (if d {e} else {f}.x))"
            .replace("(if d {e} else {f}.x)", "(if d {e} else {f})")
            + ".x"
    );
    assert_eq!(value("{ let a = 1; let b = 2; a + b }.x"), "{let a=1; let b=2; (a Add b)}.x");
    assert_eq!(
        value(
            "{ let q = p, s = 1 for i in 0..turns while length(q) < 8 { let t = abs(q) - 1; q = 2 * t, s = 2 * s }; q }"
        ),
        "{let q=p,s=1 for i in (0..turns) while (length(q) Lt 8) {let t=(abs(q) Sub 1); q=(2 Mul t),s=(2 Mul s)}; q}"
    );
}

#[test]
fn words_are_names_after_a_dot_and_before_a_colon() {
    assert_eq!(
        value("s.material(stone).light.f(for: 1, let: 2, scene: 3)"),
        "s.material(stone).light.f(for:1 let:2 scene:3)"
    );
    read(
        "camera { camera: 1, for: 2, let: 3, scene: 4 }\nmaterial m { let: 1, light: 2 }\nshape s(material: material) = nothing",
    );
}

#[test]
fn a_declaration_ends_where_the_next_starts() {
    let file = read(
        "let a = b\nfield f = p.x let c = d material m(k: float) { } scene = f light l { } mesh m \"a\" { } import \"b\" as by camera { }",
    );
    assert_eq!(file.items.len(), 9);
}

#[test]
fn the_table_of_codes_is_right_about_the_syntax() {
    for row in crate::diagnostic::CODES.iter().filter(|row| row.code < Code::TooDeep) {
        assert_eq!(
            codes(row.program),
            [row.code],
            "{}",
            shown(row.program, &parse(FileId(0), row.program).1)
        );
    }
}

#[test]
fn depth_has_an_end() {
    for (open, close) in [
        ("(", ")"),
        ("[", "]"),
        ("{", "}"),
        ("-", ""),
        ("f(", ")"),
        ("if a {", "}"),
        ("for i in a {", "}"),
        ("(1 + 2 * ", ")"),
    ] {
        let deep = |n: usize| format!("let v = {}1{}\nlet w = )", open.repeat(n), close.repeat(n));
        assert_eq!(codes(&deep(60)), [Code::Unexpected], "60 {open}");
        assert_eq!(codes(&deep(50_000)), [Code::TooDeep, Code::Unexpected], "50000 {open}");
        codes(&format!("let v = {}", open.repeat(50_000)));
        // The deepest that is still read is also written, on the stack of a test's thread.
        let deepest = (1..=MAX_NESTING)
            .rev()
            .map(|n| deep(n).replace("\nlet w = )", ""))
            .find(|t| codes(t).is_empty());
        formatting::holds(&deepest.expect("some depth is read")).unwrap();
    }
    let tall = |part: &str| format!("let v = a{}", part.repeat(50_000));
    assert_eq!(codes(&tall(".b")), [Code::TooDeep]);
    assert_eq!(codes(&tall("[0]")), [Code::TooDeep]);
    assert_eq!(
        codes(&format!("let v = if a {{ b }}{}", " else if a { b }".repeat(50_000))),
        [Code::TooDeep]
    );
    assert_eq!(
        codes(&format!("fn f(a: {}int{}) = a", "[".repeat(50_000), "]".repeat(50_000))),
        [Code::TooDeep]
    );
    assert_eq!(codes(&tall(" | a")), []);
    assert_eq!(codes(&tall(" | a & b")), []);
}
