//! What a module is asked for, and what a host writes into its uniform block.

use crate::rules::RuleSet;
use crate::source::Span;
use crate::srgb::{decode, encode};
use crate::syntax::ast::Type;
use crate::syntax::literals::{Number, read_number};
use crate::syntax::revise::Written;
use crate::unit::Unit;
use std::ops::Range;

/// Functions that a module can hold, in the order in which they are emitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Export {
    /// `sf_field(p: vec3f) -> f32`
    Field,
    /// `sf_bound(p: vec3f) -> f32`
    Bound,
    /// `sf_distance(p: vec3f) -> f32`
    Distance,
    /// `sf_gradient(p: vec3f) -> vec4f`
    Gradient,
    /// `sf_trace(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, footprint: f32) -> sf_Hit`
    Trace,
    /// `sf_shadow(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, softness: f32) -> f32`
    Shadow,
    /// `sf_collision(center: vec3f, radius: f32) -> sf_Contact`
    Collision,
    /// `sf_occlusion(p: vec3f, normal: vec3f) -> f32`
    Occlusion,
    /// `sf_surface(p: vec3f, normal: vec3f) -> sf_Surface`
    Surface,
}

impl Export {
    /// All of them, in their order.
    pub const ALL: [Export; 9] = [
        Export::Field,
        Export::Bound,
        Export::Distance,
        Export::Gradient,
        Export::Trace,
        Export::Shadow,
        Export::Collision,
        Export::Occlusion,
        Export::Surface,
    ];

    /// The name on the command line, and in the module after its prefix.
    pub fn name(self) -> &'static str {
        match self {
            Export::Field => "field",
            Export::Bound => "bound",
            Export::Distance => "distance",
            Export::Gradient => "gradient",
            Export::Trace => "trace",
            Export::Shadow => "shadow",
            Export::Collision => "collision",
            Export::Occlusion => "occlusion",
            Export::Surface => "surface",
        }
    }
}

/// How a module declares what a host sets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Uniforms {
    /// One uniform block.
    #[default]
    Block,
    /// A private variable, a struct of all of them with the values at the start: the shader itself sets what it wants to change before it calls anything.
    /// Nothing else has to be computed, as with [`Options::live_in_shader`].
    Private,
    /// A uniform variable for each, from [`Options::binding`] on.
    Separate,
}

/// Whether a module draws the scene by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Entry {
    /// It holds functions alone.
    #[default]
    None,
    /// It has the entry points `sf_vertex`, a triangle over the target, and `sf_fragment`, the scene in its light, with its depth.
    Draw,
}

/// What a module that draws makes of light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Colors {
    /// A screen's colours after the scene's tone curve, encoded as sRGB.
    #[default]
    Screen,
    /// The same, not encoded: for targets that encode them.
    Linear,
    /// Light times the exposure, for hosts that have a tone curve of their own.
    Light,
}

/// What a module that draws is told of the view. All but the picture's size is as the scene's first camera has it at the start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewField {
    /// Where the eye is, in the scene.
    Eye,
    /// Vertical angle of view, radians.
    Fov,
    /// How much of the scene is seen from the picture's lower edge to its upper one, where rays go side by side; in place of [`ViewField::Fov`].
    Height,
    /// What it looks at, in the scene.
    LookAt,
    /// The distance ahead at which the depth is 0.
    Near,
    /// What is up in the picture, of any length.
    Up,
    /// The distance ahead at which the depth is 1.
    Far,
    /// Width and height of the picture in pixels.
    Size,
    /// The picture's upper left corner on the target, in pixels.
    Corner,
}

impl ViewField {
    /// All of them, in an order that leaves no gap in a block.
    pub const ALL: [ViewField; 9] = [
        ViewField::Eye,
        ViewField::Fov,
        ViewField::Height,
        ViewField::LookAt,
        ViewField::Near,
        ViewField::Up,
        ViewField::Far,
        ViewField::Size,
        ViewField::Corner,
    ];

    /// Its name in the module.
    pub fn name(self) -> &'static str {
        match self {
            ViewField::Eye => "view_eye",
            ViewField::Fov => "view_fov",
            ViewField::Height => "view_height",
            ViewField::LookAt => "view_look_at",
            ViewField::Near => "view_near",
            ViewField::Up => "view_up",
            ViewField::Far => "view_far",
            ViewField::Size => "view_size",
            ViewField::Corner => "view_corner",
        }
    }

    /// Number of floats.
    pub fn components(self) -> u8 {
        match self {
            ViewField::Eye | ViewField::LookAt | ViewField::Up => 3,
            ViewField::Size | ViewField::Corner => 2,
            _ => 1,
        }
    }

    /// What it is, for people.
    pub fn about(self) -> &'static str {
        match self {
            ViewField::Eye => "where the eye is",
            ViewField::Fov => "vertical angle of view, radians",
            ViewField::Height => "how much of the scene is seen from the lower edge to the upper one",
            ViewField::LookAt => "what the eye looks at",
            ViewField::Near => "the distance ahead at which the depth is 0",
            ViewField::Up => "what is up in the picture",
            ViewField::Far => "the distance ahead at which the depth is 1; less than near for a reversed depth",
            ViewField::Size => "width and height of the picture in pixels",
            ViewField::Corner => "its upper left corner on the target in pixels",
        }
    }
}

/// What a module shall hold and how it is named.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The functions asked for. What they call is emitted too.
    pub exports: Vec<Export>,
    /// Before every name of the module.
    pub prefix: String,
    /// Bind group of the uniform block.
    pub group: u32,
    /// Binding of the uniform block, or of the first uniform variable.
    pub binding: u32,
    /// How the module declares what a host sets.
    pub uniforms: Uniforms,
    /// Whether the module draws the scene by itself.
    pub entry: Entry,
    /// What it makes of light then.
    pub colors: Colors,
    /// Values of parameters that replace those in the text, by the name that a person sees (`spin`, `column.flutes`):
    /// components of a number, colour or vector.
    pub set: Vec<(String, Vec<f64>)>,
    /// Choices of parameters that replace those in the text: the parameter's name and the choice's.
    pub choose: Vec<(String, String)>,
    /// Whether a formula of which no bound can be proven is an error.
    pub strict: bool,
    /// Whether what depends on parameters and time alone is computed in the shader, so that a host need write nothing else into the
    /// uniform block; else it has fields there ([`UniformSource::Formula`]).
    pub live_in_shader: bool,
    /// Radius about the origin within which a scene is drawn that does not say it: what is given, else 100 or what all that is solid needs.
    pub extent: Option<f64>,
    /// The rules by which bounds may become tighter.
    pub rules: RuleSet,
}

impl Options {
    /// The binding of the first of the two buffers with tables, after all of so many uniform values.
    pub fn first_buffer(&self, fields: usize) -> u32 {
        let taken = match self.uniforms {
            Uniforms::Block => 1,
            Uniforms::Private => 0,
            Uniforms::Separate => fields as u32,
        };
        self.binding.saturating_add(taken)
    }
}

impl Default for Options {
    fn default() -> Self {
        Self {
            exports: Export::ALL.to_vec(),
            prefix: "sf_".to_owned(),
            group: 0,
            binding: 0,
            uniforms: Uniforms::default(),
            entry: Entry::default(),
            colors: Colors::default(),
            set: Vec::new(),
            choose: Vec::new(),
            strict: false,
            live_in_shader: false,
            extent: None,
            rules: RuleSet::default(),
        }
    }
}

/// A parameter as a person sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// `spin`, or `column.flutes` for one of an import.
    pub name: String,
    /// `Bool`, `Int`, `Float`, `Vec(n)` or `Color`; `Str` where it chooses among names.
    pub ty: Type,
    /// Whether it is shown in degrees (its numbers are radians).
    pub degrees: bool,
    /// The unit in which it is shown, and how many units of the scene that is, where its value or range is written as a length.
    pub length: Option<(Unit, f64)>,
    /// Its components at the start. A choice: the index of the name that the text chooses.
    pub default: Vec<f64>,
    /// Least value of each component.
    pub min: Vec<f64>,
    /// Greatest value of each component.
    pub max: Vec<f64>,
    /// The names that it chooses among; empty for numbers.
    pub choices: Vec<String>,
    /// What a person should know of it.
    pub description: Option<String>,
    /// Where it is declared.
    pub span: Span,
    /// Index of its first component in [`Graph::parameters`]; a choice has none, and recompiles.
    pub first: Option<u32>,
}

impl Parameter {
    /// The indices of its components in [`Graph::parameters`]; a choice has none.
    pub fn components(&self) -> Range<u32> {
        self.first.map_or(0..0, |first| first..first + self.default.len() as u32)
    }

    /// The name that the text chooses; none where it does not choose among names.
    pub fn choice(&self) -> Option<&str> {
        self.choices.get(*self.default.first()? as usize).map(String::as_str)
    }

    /// Decimals with which a ten-thousandth of its range can be told, as a person reads it: angles in degrees.
    pub fn decimals(&self, component: usize) -> usize {
        let ends = self.min.get(component).zip(self.max.get(component));
        let range = ends.map_or(0.0, |(min, max)| (max - min) / self.unit());
        match range > 0.0 && self.ty != Type::Int {
            true => (4.0 - range.log10()).ceil().clamp(1.0, 9.0) as usize,
            false if self.ty == Type::Int => 0,
            false => 3,
        }
    }

    /// How much 1 is, as a person reads it.
    pub fn unit(&self) -> f64 {
        if self.degrees { 1f64.to_radians() } else { self.length.map_or(1.0, |(_, scale)| scale) }
    }

    /// What is written right after its numbers, as a person reads them: `deg`, `mm`, or nothing.
    pub fn suffix(&self) -> &'static str {
        if self.degrees { "deg" } else { self.length.map_or("", |(unit, _)| unit.name()) }
    }

    /// A number that a person writes in place of what is shown: a bare one in the unit that is shown, or one with its own unit. None where it is none.
    pub fn read(&self, text: &str) -> Option<f64> {
        let text = text.trim();
        let (sign, text) = text.strip_prefix(['-', '−']).map_or((1.0, text), |rest| (-1.0, rest.trim()));
        let shown = match (read_number(&text.split_whitespace().collect::<String>()).ok()?, self.length) {
            (Number::Int(value), _) => value as f64,
            (Number::Float(value), _) => value,
            (Number::Angle(value, unit), _) if self.degrees => unit.radians(value) / self.unit(),
            (Number::Length(value, unit), Some((shown, _))) => unit.to(shown, value),
            (Number::Angle(..) | Number::Length(..), _) => return None,
        };
        Some(sign * shown)
    }

    /// A number in a person's unit, with no more digits than its range tells apart and no zeros at the end.
    pub fn digits(&self, component: usize, shown: f64) -> String {
        let decimals = self.decimals(component);
        let text = format!("{shown:.decimals$}");
        let short = if decimals > 0 { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
        if short == "-0" { "0".to_owned() } else { short.to_owned() }
    }

    /// A number, vector, condition or colour as the text may have it, within the range.
    pub fn written(&self, value: &[f64]) -> Written {
        let number = |(i, value): (usize, &f64)| {
            let shown = value / self.unit();
            let short = self.digits(i, shown);
            let read = short.parse::<f64>().unwrap_or(shown) * self.unit();
            let within = self.min.get(i).is_none_or(|min| read >= *min) && self.max.get(i).is_none_or(|max| read <= *max);
            let unit = self.suffix();
            if within { format!("{short}{unit}") } else { format!("{shown}{unit}") }
        };
        let all = |value: &[f64]| match value {
            [one] => number((0, one)),
            many => format!("({})", many.iter().enumerate().map(number).collect::<Vec<_>>().join(", ")),
        };
        let range = || Some(format!("{}..{}", all(&self.min), all(&self.max)));
        match (&self.ty, value) {
            (Type::Bool, [on]) => Written::Value((*on != 0.0).to_string(), None),
            (Type::Color, _) => Written::Value(self.color(value).unwrap_or_else(|| all(value)), None),
            _ => Written::Value(all(value), range()),
        }
    }

    /// A colour by its bytes, where it lies within those and its bytes within its range.
    fn color(&self, value: &[f64]) -> Option<String> {
        let bytes: Vec<f64> = value.iter().map(|c| (255.0 * encode(*c)).round()).collect();
        let mut ends = self.min.iter().zip(&self.max).zip(value.iter().zip(&bytes));
        let fits = ends.all(|((min, max), (c, byte))| (0.0..=1.0).contains(c) && (*min..=*max).contains(&decode(byte / 255.0)));
        fits.then(|| bytes.iter().fold("#".to_owned(), |text, byte| format!("{text}{:02x}", *byte as u8)))
    }
}

/// Where a field of the uniform block takes its value from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum UniformSource {
    /// The scene point at which `p` is zero: a `vec3f`.
    Origin,
    /// Seconds.
    Time,
    /// So many components from this index of [`Graph::parameters`] on.
    Parameter(u32),
    /// How far occlusion reaches.
    OcclusionReach,
    /// How strong occlusion is, 0 to 1.
    OcclusionStrength,
    /// The multiple of a factor: an index into [`Graph::factors`]; the value is one over its Lipschitz factor, rounded down.
    Factor(u32),
    /// What is computed from time and parameters: a field of [`Module::formulas`].
    Formula(u32),
    /// The view, in a module that draws.
    View(ViewField),
}

/// A field of the uniform block.
#[derive(Clone, Debug, PartialEq)]
pub struct Uniform {
    /// Its name in the struct.
    pub name: String,
    /// Where its value comes from.
    pub source: UniformSource,
    /// Number of 32-bit floats: 1 to 4.
    pub components: u32,
    /// Byte offset in the block.
    pub offset: u32,
}

/// What rounding in 32 bits grows with where a module computes the field: with coordinates, the way of a ray, and a length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rounding {
    /// The axes along which it grows with the distance from the scene's middle. Along the others it grows with that from the module's own origin
    /// alone: all that is read of the scene's point there are ways from places far out.
    pub reads_scene: [bool; 3],
    /// The length, which stands for what else is added in the formulas: 1 for scenes of ordinary size, less where all of a scene is smaller, and more
    /// where large numbers cancel each other.
    pub unit: f64,
}

impl Rounding {
    /// That of formulas of ordinary size, of which no axis is read as it is.
    pub const ORDINARY: Self = Self { reads_scene: [false; 3], unit: 1.0 };
}
