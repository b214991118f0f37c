//! Where a ray is in its search, step for step as in the text of `compiler/src/emit/tracer.rs`.

use super::march::{Look, Ray};
use crate::emit::tracer::Tracer;

/// How rays are followed.
pub const TRACER: Tracer = Tracer::DEFAULT;

/// What comes of a look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Turn {
    /// The surface is so far along the ray.
    Hit(f64),
    /// Nothing was met up to the ray's end.
    Missed,
    /// The next look is so far along the ray.
    Go(f64),
}

/// What a ray does after a look.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// It goes as far as the bound says.
    Whole,
    /// It goes farther than the bound says, as the slope along the ray allows.
    Longer,
    /// It goes straight to where the line through the last two looks is zero.
    Leap,
    /// It goes back to the end of the last sphere: the two spheres do not touch, and a surface may lie between.
    Back,
    /// It has arrived, and looks once more where the surface is by the line.
    Closer,
    /// It met the surface.
    Hit,
    /// It is at its end.
    Missed,
    /// It has spent its looks.
    Spent,
}

impl Kind {
    /// In a word or two.
    pub fn name(self) -> &'static str {
        match self {
            Self::Whole => "bound",
            Self::Longer => "longer",
            Self::Leap => "leap",
            Self::Back => "back",
            Self::Closer => "closer",
            Self::Hit => "hit",
            Self::Missed => "end",
            Self::Spent => "spent",
        }
    }

    /// Of a look: where the ray was in its search before and after it, what came of it, the bound, and whether the looks are spent.
    pub fn of(before: &Follow, after: &Follow, turn: &Turn, free: f64, is_spent: bool) -> Self {
        match turn {
            Turn::Hit(_) => Self::Hit,
            Turn::Missed => Self::Missed,
            Turn::Go(_) if is_spent => Self::Spent,
            Turn::Go(_) if after.last => Self::Closer,
            Turn::Go(_) if before.has_gap(free) => Self::Back,
            Turn::Go(_) => after.kind(),
        }
    }
}

/// What is small where a ray looks.
#[derive(Clone, Copy, Debug)]
pub struct Small {
    /// How wide a pixel is there.
    pub pixel: f64,
    /// How far rounding in 32 bits may be off.
    pub rounding: f64,
}

/// The variables of `sf_trace`.
#[derive(Clone, Copy, Debug)]
pub struct Follow {
    /// Of the last sphere that is known to be empty.
    radius: f64,
    /// The bound at its centre.
    seen: f64,
    /// From there to here.
    stride: f64,
    /// How the bound changes along the ray, as far as that is learnt.
    slope: f64,
    /// How it changed over the step before.
    before: f64,
    /// Whether the last step was a leap.
    leapt: bool,
    /// Whether the ray has arrived, and looks once more.
    last: bool,
    /// How often it has looked.
    pub steps: u32,
}

impl Follow {
    /// At the ray's beginning, before the first look.
    pub const START: Self = Self { radius: 0.0, seen: 0.0, stride: 0.0, slope: -1.0, before: -1.0, leapt: false, last: false, steps: 0 };

    /// Whether the sphere of a bound here does not touch the last one that is known to be empty: a gap between the two may hold a surface.
    fn has_gap(&self, free: f64) -> bool {
        self.stride > self.radius.max(self.radius + free)
    }

    /// What the step is that it takes now, of a ray that goes on.
    fn kind(&self) -> Kind {
        match self.leapt {
            true => Kind::Leap,
            false if self.stride > self.radius => Kind::Longer,
            false => Kind::Whole,
        }
    }

    /// How near is near enough at the next look.
    pub fn tolerance(&self, small: &Small) -> f64 {
        let spent = f64::from(self.steps + 1) / f64::from(TRACER.budget);
        ((TRACER.tolerance + Tracer::TIRED * spent * spent) * small.pixel).max(small.rounding)
    }

    /// One look along `ray`, with the `distance` to the surface where the bound is within the tolerance.
    pub fn turn(&mut self, look: &Look, distance: Option<f64>, small: &Small, ray: &Ray) -> Turn {
        let tolerance = self.tolerance(small);
        let pixel = small.pixel;
        self.steps += 1;
        let free = look.free;
        let change = if self.stride != 0.0 { (free - self.seen) / self.stride } else { -1.0 };
        let fall = (-change).max(Tracer::FLATTEST);
        let ahead = (free - small.rounding) / fall;
        let gap = self.has_gap(free);
        let near = free <= tolerance && (!gap || self.leapt && free >= 0.0) && distance.is_some_and(|d| d <= tolerance);
        if self.last || near {
            let stride = self.stride.abs();
            let most = if self.last { stride } else { Tracer::ASIDE * pixel };
            let t = (look.t + ahead.clamp(-most.min(stride), most)).clamp(ray.t_min, ray.t_max);
            let on = t - look.t;
            if self.last || self.steps >= TRACER.budget || on.abs() <= Tracer::FINE * pixel {
                return Turn::Hit(t);
            }
            *self = Self { last: true, stride: on, seen: free, ..*self };
            return Turn::Go(t);
        }
        if gap {
            let t = look.t + self.radius - self.stride;
            *self = Self { stride: self.radius, slope: -1.0, leapt: false, ..*self };
            return Turn::Go(t);
        }
        if look.t >= ray.t_max {
            return Turn::Missed;
        }
        self.slope = (self.slope + TRACER.relaxation * (change - self.slope)).clamp(-1.0, Tracer::STEEPEST);
        self.radius = free.max(0.5 * tolerance);
        self.seen = free;
        let stride = self.radius * 2.0 / (1.0 - self.slope);
        let close = ahead - free <= TRACER.leap * pixel;
        let leap = ahead * (1.0 - Tracer::FASTER * (self.before - change).max(0.0) / fall);
        self.leapt = leap > stride && close && (change - self.before).abs() * ahead <= Tracer::EVEN * tolerance;
        self.before = change;
        self.stride = if self.leapt { leap } else { stride }.min(ray.t_max - look.t);
        Turn::Go(look.t + self.stride)
    }
}
