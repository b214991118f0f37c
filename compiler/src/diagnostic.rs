//! What the compiler says to a person: where, what, and what to write instead.

use crate::source::{Sources, Span};
use codespan_reporting::diagnostic as codespan;
use codespan_reporting::files::SimpleFiles;
use codespan_reporting::term;

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// The scene is drawn; something should be known.
    Warning,
    /// The scene can't be drawn.
    Error,
}

/// One thing that the compiler says.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// Its row in the table of codes.
    pub code: Code,
    /// From the table of codes.
    pub severity: Severity,
    /// What is wrong, in one sentence without a full stop.
    pub message: String,
    /// The text that is underlined.
    pub span: Span,
    /// Other places that matter, each with a few words.
    pub labels: Vec<(Span, String)>,
    /// What to write instead.
    pub help: String,
    /// What `help` says, as edits that an editor can make; where there are several, one of them is meant.
    pub fixes: Vec<Fix>,
}

/// A text in place of another.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Edit {
    /// What is replaced; empty where something is put in.
    pub span: Span,
    /// What stands there then.
    pub text: String,
}

/// A way to mend what a diagnostic speaks of.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Fix {
    /// What it does, in a few words: ``Write `sphere` ``.
    pub title: String,
    /// The edits, none over another.
    pub edits: Vec<Edit>,
}

impl Diagnostic {
    /// A diagnostic of a code; its severity comes from the table. `help` says what to write instead.
    pub fn new(code: Code, span: Span, message: impl Into<String>, help: impl Into<String>) -> Self {
        Self {
            code,
            severity: code.row().severity,
            message: message.into(),
            span,
            labels: Vec::new(),
            help: help.into(),
            fixes: Vec::new(),
        }
    }

    /// The same at another place; the present one is kept with a few words.
    pub fn at(mut self, span: Span, words: impl Into<String>) -> Self {
        let before = std::mem::replace(&mut self.span, span);
        self.label(before, words)
    }

    /// Adds a way to mend it: what stands instead of a piece of text.
    pub fn write(mut self, span: Span, text: impl Into<String>) -> Self {
        let text = text.into();
        let title = match text.trim() {
            "" => "Delete it".to_owned(),
            written => format!("Write `{written}`"),
        };
        self.fixes.push(Fix { title, edits: vec![Edit { span, text }] });
        self
    }

    /// The same, where there is something to write.
    pub fn write_if(self, span: Span, text: Option<impl Into<String>>) -> Self {
        match text {
            Some(text) => self.write(span, text),
            None => self,
        }
    }

    /// Adds another place that matters.
    pub fn label(mut self, span: Span, words: impl Into<String>) -> Self {
        self.labels.push((span, words.into()));
        self
    }
}

/// A row of the table of codes.
pub struct CodeRow {
    /// The code.
    pub code: Code,
    /// How it is printed: `syntax-unexpected`.
    pub name: &'static str,
    /// How bad it is.
    pub severity: Severity,
    /// Why it is wrong and how to mend it, for a person who meets it first.
    pub explanation: &'static str,
    /// The smallest program that triggers it.
    pub program: &'static str,
}

macro_rules! codes {
    ($($variant:ident, $name:literal, $severity:ident, $explanation:literal, $program:literal;)*) => {
        /// Everything that the compiler can say.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Code { $(#[doc = $explanation] $variant,)* }

        /// The table of codes, in the order of [`Code`].
        pub const CODES: &[CodeRow] = &[$(CodeRow {
            code: Code::$variant, name: $name, severity: Severity::$severity,
            explanation: $explanation, program: $program,
        },)*];

        impl Code {
            /// Its row in the table.
            pub fn row(self) -> &'static CodeRow {
                match self { $(Code::$variant => &CodeRow {
                    code: Code::$variant, name: $name, severity: Severity::$severity,
                    explanation: $explanation, program: $program,
                },)* }
            }
        }
    };
}

codes! {
    Character, "character", Error,
        "A character that the language does not use. Names are made of letters, digits and `_`; text stands between straight double quotes; a power is `pow(a, b)`.",
        "scene = sphere(1) $ box(1)";
    NumberForm, "number-form", Error,
        "A number that can't be read, or is too large for the GPU. Numbers are decimal, with one point at most; a unit stands right after its number: `deg`, `turn` and `rad` are angles, `um`, `mm`, `cm`, `m`, `in` and `ft` lengths.",
        "let a = 1e999\nscene = sphere(1)";
    StringForm, "string-form", Error,
        "A text that does not end on its line, or an escape that is not known. Texts stand between double quotes; `\\\"`, `\\\\`, `\\n` and `\\t` are the escapes, and paths are written with `/`.",
        "import \"a.sdf\nscene = sphere(1)";
    ColorForm, "color-form", Error,
        "A colour is `#` and three or six hexadecimal digits: `#d4af37`. There is no transparency.",
        "let c = #12\nscene = sphere(1)";
    CommentForm, "comment-form", Error,
        "A `/*` without its `*/`. Comments nest, so each `/*` needs its own.",
        "scene = sphere(1) /* a ball";
    Unexpected, "unexpected", Error,
        "Something else was expected here. The message says what was found and what was expected; the rest of the file is read as if that one place were right.",
        "scene = sphere(1) + ) box(1)";
    Unclosed, "unclosed", Error,
        "A bracket without its partner. The partner is searched for up to the next declaration, so the rest of the file is still checked.",
        "scene = sphere(1";
    TooDeep, "too-deep", Error,
        "Brackets, blocks or calls are nested deeper than 200 levels, the most that the compiler accepts. Name a part of it with `let` or `shape`, and use the name.",
        "scene = ((…))";
    Encoding, "encoding", Error,
        "The text is not UTF-8. Save the file as UTF-8; the message says where the first wrong byte stands.",
        "";
    Unreadable, "unreadable", Error,
        "A file that can't be read. Paths are relative to the file that names them, and are written with `/`.",
        "import \"nowhere.sdf\"\nscene = sphere(1)";
    BrokenFile, "broken-file", Error,
        "A mesh, a font or an SVG that can't be read, or whose content does not match its file name: empty, cut short, or with invalid numbers. The rest of the scene is drawn without it.",
        "";
    Shader, "shader", Error,
        "A shader that can't be read, or a function of it that the language can't say: one that reads textures or pixels beside, that works on the bits of numbers, or whose loops have no end that can be found. The message says where in the shader.",
        "";
    ImportCircle, "import-circle", Error,
        "Files that import each other in a circle. Move what both need into a third file, and import that.",
        "import \"main.sdf\"\nscene = sphere(1)";
    TwiceDeclared, "twice-declared", Error,
        "One name is declared twice. A file has one namespace for everything; give one of the two another name.",
        "let a = 1\nlet a = 2\nscene = sphere(a)";
    Ambiguous, "ambiguous", Error,
        "A name comes from two imports. Put one of them behind a name, `import \"parts/sky.sdf\" as sky`, and write `sky.dusk`.",
        "";
    UnknownName, "unknown-name", Error,
        "A name that nothing declares: neither this place, this file, its imports, nor the prelude. Names of blocks and loops end with them.",
        "scene = spere(1)";
    UnknownMember, "unknown-member", Error,
        "The name after the dot does not exist for this value: the vector has no such component, or there is no such call.",
        "scene = sphere(1).twst(y, 1)";
    UnknownKey, "unknown-key", Error,
        "A block has no such key. The message lists the keys that it has.",
        "camera { eyes: (0, 0, 3) }\nscene = sphere(1)";
    UnknownType, "unknown-type", Error,
        "A type that the language does not have. Numbers are `float` or `int`, points `vec2` and `vec3`, lists `[T]`.",
        "field f(a: number) = length(p) - a\nscene = f(1)";
    MissingArgument, "missing-argument", Error,
        "A call lacks an argument that has no default.",
        "scene = sphere()";
    ExtraArgument, "extra-argument", Error,
        "A call has more arguments than the declaration takes.",
        "scene = sphere(1, 2)";
    UnknownArgument, "unknown-argument", Error,
        "A named argument that the declaration does not have, or one given twice.",
        "scene = sphere(r: 1)";
    TypeMismatch, "type-mismatch", Error,
        "A value of another type is needed here. A number stands for a vector of equal components; otherwise types are not converted.",
        "scene = sphere(true)";
    NoPoint, "no-point", Error,
        "`p`, `normal` or `world` is used where it does not exist. `p` exists in `field`, `warp`, `blend` and `material`, and in arguments declared `field`. A `fn` and a `let` of the file have no `p`: pass it as an argument.",
        "fn f(t) = t * p.x\nscene = sphere(f(1))";
    NotConstant, "not-constant", Error,
        "This must be known at compile time: the length of a list, the number of repetitions, the extent of the scene. It can't depend on a `param`, on `time` or on `p`.",
        "param n = 3 in 1..5\nscene = metaballs([for i in 0..n { (i, 0, 0, 1) }])";
    BadValue, "bad-value", Error,
        "A value that makes no sense here: a negative radius, a zero scale, an empty range, a division by zero. A live value is kept within its range instead.",
        "scene = sphere(-1)";
    NoUnit, "no-unit", Error,
        "A length with a unit, as `10mm`, in a scene that does not say what its own unit is. Write `render { unit: mm }`, and all lengths become numbers of millimetres.",
        "scene = box(10mm)";
    BadRange, "bad-range", Error,
        "A range or list of choices that does not fit its parameter: the value lies outside, the ends are swapped, or a needed range is missing.",
        "param a = 3 in 0..2\nscene = sphere(a)";
    OutOfBounds, "out-of-bounds", Error,
        "An index beyond the end of its list. The first item is `list[0]`, the last `list[list.count - 1]`.",
        "let l = [1, 2]\nscene = sphere(l[2])";
    EndlessCall, "endless-call", Error,
        "A declaration calls itself without end. The `if` that ends it must be decidable at compile time.",
        "shape a = a\nscene = a";
    TooLarge, "too-large", Error,
        "The scene unfolds to more operations than the compiler takes. Repeat with `grid` or `polar`, which cost one copy, in place of a `for` over many.",
        "scene = for i in 0..100000000 { sphere(i) }";
    NoScene, "no-scene", Error,
        "The file has no `scene`, so there is nothing to draw. Write `scene = …`; files that are only imported need none.",
        "shape a = sphere(1)";
    NoBound, "no-bound", Error,
        "No finite bound is known for this formula, so rays can't step safely. Keep divisors away from zero, or cut the formula with `.within(region)`.",
        "field f = p.x * exp(exp(900 + abs(p.y)))\nscene = f";
    Unproven, "unproven", Warning,
        "The picture of this formula is not proven: rays may step through its surface. Either no finite bound is known, or the known one makes steps too short to be of use; the formula is then drawn with a factor measured at samples. Or the formula jumps, and both sides of the jump agree at all samples. With `--strict` only proven bounds are used, and a formula without one is an error. Keep divisors and the arguments of roots away from zero, clamp what grows without end, or cut the formula with `.within(region)`.",
        "field f = 1 / p.x\nscene = f";
    NoReach, "no-reach", Error,
        "The body of a repetition reaches too far, or has no end, so that too many neighbouring copies would have to be evaluated. Make the cells larger or cut the body with `.within(region)`.",
        "scene = for c in grid((1, 1, 1)) { plane(y) }";
    PreludeOnly, "prelude-only", Error,
        "A claim can be made only in the prelude; the compiler derives it for you.",
        "field f exact = length(p) - 1\nscene = f";
    BadImage, "bad-image", Error,
        "An image that can't be read, is broken, or is too large. The rest of the scene is drawn. A cubemap is a folder with px, nx, py, ny, pz and nz, squares of one size; all images are PNG, JPEG or HDR.",
        "";
    ExtentUsed, "extent-used", Warning,
        "This formula has no bound over all space. It is proven and drawn only within the scene's extent, which `render { extent: … }` sets.",
        "";
    NothingSolid, "nothing-solid", Warning,
        "Nothing solid lies within the scene's extent, so the picture shows only the sky. Move the scene toward the origin, or set `render { extent: … }` to more. Shapes that do not meet have no intersection, and a drawing without an inside, such as a `segment`, needs a width: `.round(0.05)`.",
        "scene = sphere(1).translate(150, 0, 0)\nrender { extent: 100 }";
    InsideSolid, "inside-solid", Warning,
        "The camera or a light stands inside a solid. From such a camera the picture is mostly black: move its `eye` out. If the shape is meant as a room, subtract its inside: `box(9) - box(8)`. If a light stands inside, like a lamp in its bulb, everything lies in the bulb's shadow: `shadow: none` lets it shine through.",
        "scene = box(4)\ncamera { eye: (0, 0, 1) }";
    NothingSeen, "nothing-seen", Warning,
        "The camera sees nothing solid, so the picture shows only the sky. Point the camera at the scene, or set `render { max_distance: … }` to at least the distance of the scene.",
        "scene = sphere(1)\ncamera { eye: (0, 0, 5), target: (0, 0, 9) }";
    RaysLost, "rays-lost", Warning,
        "In a part of the picture, rays use up all their steps before they hit anything. That part shows the sky, or a surface that does not exist. Say where the shape lies with `.within(box(…))`, or write its formula so that it grows more evenly.",
        "field f = { let r = floor(9 * p.z); p.y - 9 / (1 + abs(floor(9 * p.x + 0.5 * r)) + abs(r)) }\nscene = f";
    UnderAPixel, "under-a-pixel", Warning,
        "The scene has no camera, and from the camera that is chosen for it the solid is thinner than a pixel. The picture shows almost nothing. Add a camera that is nearer, or make the solid thicker.",
        "scene = box((1000, 0.001, 0.001))";
    FewDigits, "few-digits", Warning,
        "Two large numbers cancel each other here. A graphics adapter computes with 24 bits, and too few of them remain: surfaces and shadows are off by about a pixel or more. If a length and a radius cancel, as on the ground of a planet that is only moved and turned, the compiler writes a better formula. A warp between them prevents that. Make the scene smaller, or remove the warp.",
        "scene = sphere(1e6).twist(y, 1e-7).translate(0, -1e6, 0) | sphere(1)\ncamera { eye: (4, 3, 6), target: (0, 0, 0) }";
    Jump, "jump", Warning,
        "The formula jumps here. Rays stop before the jump and evaluate the formula again, which takes time. If both sides of the jump are proven to agree, there is no warning.",
        "field f = length(p) - 1 + floor(4 * p.x) / 9\nscene = f";
    Unused, "unused", Warning,
        "A parameter that nothing reads. Its slider would do nothing.",
        "param a = 1 in 0..2\nscene = sphere(1)";
    RangeReach, "range-reach", Warning,
        "The range of a parameter includes invalid values: a radius below zero, a scale of zero, a negative blend. There the nearest valid value is used, so that part of the slider does nothing. End the range before it.",
        "param r = 1 in -1..2\nscene = sphere(r)";
    BareAngle, "bare-angle", Warning,
        "An angle of more than a whole turn, written without a unit. Such a number is in radians. Write `45deg`, or `45rad` where radians are meant.",
        "scene = box(1).rotate(y, 45)";
    NotWhole, "not-whole", Warning,
        "`hash` takes whole numbers and rounds this one, so `hash(1.2)` equals `hash(1.4)`. Pass a whole number, such as the index of a `for` or `floor(p)`. For a value that changes smoothly, write `value_noise(p)`.",
        "scene = sphere(hash(1.2))";
    ColorBytes, "color-bytes", Warning,
        "A colour with components above 1, like bytes. Components of a colour go from 0 to 1. To write bytes, use the form `#c87828`.",
        "material m { color: (200, 120, 40) }\nscene = sphere(1).material(m)";
    Costly, "costly", Warning,
        "One evaluation of the scene takes so many operations that a picture may take minutes, or nested factors multiply to more steps than a ray has. Copies that are joined by a `for`, or repeated, are evaluated only near the point.",
        "";
    Gaps, "gaps", Warning,
        "The copies of a repetition are rounded or blended by more than the distance within which the compiler evaluates copies around a point. Where the nearest copies are farther away, the gaps between them fill up. Round or blend each copy inside the braces, or make the cells larger.",
        "scene = (for c in grid((1, 1, 1)) { if c.x % 9 == 0 { sphere(0.2) } }).round(3)";
    LeftOut, "left-out", Warning,
        "A part of an SVG is not in the drawing: only fills are. Turn strokes into paths in the program that drew it, or write `path(\"…\").stroke(0.1)`.",
        "";
    NoRoom, "no-room", Warning,
        "The balls of a group do not fit into the box where they start: they overlap at the start and push apart. Or that box lies outside the walls.",
        "scene = plane(y)\nballs b { count: 1000, radius: 0.5, spawn: (0, 1, 0)..(1, 2, 1) }";
}

/// More diagnostics than these nobody reads.
pub const MOST_SHOWN: usize = 100;

/// The diagnostics that are shown to a person, in their order, and how many are not: of very many the first errors, then warnings.
pub fn shown(diagnostics: &[Diagnostic]) -> (Vec<&Diagnostic>, usize) {
    let of = |severity| diagnostics.iter().enumerate().filter(move |(_, d)| d.severity == severity);
    let mut some: Vec<(usize, &Diagnostic)> = of(Severity::Error).chain(of(Severity::Warning)).take(MOST_SHOWN).collect();
    some.sort_by_key(|(i, _)| *i);
    (some.into_iter().map(|(_, d)| d).collect(), diagnostics.len().saturating_sub(MOST_SHOWN))
}

/// Renders diagnostics with the lines that they speak of. `color` adds ANSI colours.
pub fn render(sources: &Sources, diagnostics: &[Diagnostic], color: bool) -> String {
    let mut files = SimpleFiles::new();
    for (_, file) in sources.iter() {
        files.add(file.name.clone(), file.text.to_string());
    }
    let config = term::Config::default();
    let mut out = String::new();
    let (diagnostics, more) = shown(diagnostics);
    for diagnostic in diagnostics {
        let shown = to_codespan(diagnostic);
        let written = if color {
            let mut buffer = term::termcolor::Ansi::new(Vec::new());
            let done = term::emit_to_write_style(&mut buffer, &config, &files, &shown);
            done.ok().map(|()| String::from_utf8_lossy(&buffer.into_inner()).into_owned())
        } else {
            let mut text = String::new();
            term::emit_to_string(&mut text, &config, &files, &shown).ok().map(|()| text)
        };
        match written {
            Some(text) => out.push_str(&text),
            None => out.push_str(&format!("{}\n", diagnostic.message)),
        }
    }
    if more > 0 {
        out.push_str(&format!("… and {more} more\n\n"));
    }
    out
}

fn to_codespan(diagnostic: &Diagnostic) -> codespan::Diagnostic<usize> {
    let severity = match diagnostic.severity {
        Severity::Error => codespan::Severity::Error,
        Severity::Warning => codespan::Severity::Warning,
    };
    let range = |span: Span| (span.file.0 as usize, span.range());
    let (file, bytes) = range(diagnostic.span);
    let mut labels = vec![codespan::Label::primary(file, bytes)];
    labels.extend(diagnostic.labels.iter().map(|(span, words)| {
        let (file, bytes) = range(*span);
        codespan::Label::secondary(file, bytes).with_message(words)
    }));
    let mut shown = codespan::Diagnostic::new(severity)
        .with_code(diagnostic.code.row().name)
        .with_message(&diagnostic.message)
        .with_labels(labels);
    if !diagnostic.help.is_empty() {
        shown = shown.with_notes(vec![format!("help: {}", diagnostic.help)]);
    }
    shown
}

/// In the order of their places, each once, errors before warnings of one place.
pub(crate) fn tidy(diagnostics: &mut Vec<Diagnostic>) {
    diagnostics.sort_by_key(|d| (d.span.file, d.span.start, d.severity != Severity::Error, d.code));
    diagnostics.dedup_by(|a, b| a.code == b.code && a.span == b.span);
    // How a named argument is written is said by what names it might have.
    let unknown: Vec<Span> = diagnostics.iter().filter(|d| d.code == Code::UnknownArgument).map(|d| d.span).collect();
    diagnostics.retain(|d| d.code != Code::Unexpected || !unknown.contains(&d.span));
}
