//! All balls of a scene, step by step.

use super::{Ball, Field, Ground, Law, MEETINGS, meet, travel};
use crate::compiled::Compiled;
use crate::live::Live;
use crate::evaluate::TooLarge;
use crate::vector::{Vec3, dot, scale};

/// Balls, and the time that passed for them.
#[derive(Clone, Debug, Default)]
pub struct World {
    /// The balls.
    pub balls: Vec<Ball>,
    /// Seconds since the start.
    pub time: f64,
    /// The index of a ball that a hand holds, and where it pulls it to.
    pub held: Option<(usize, Vec3)>,
}

impl World {
    /// Balls at the start.
    pub fn new(balls: Vec<Ball>) -> Self {
        Self { balls, time: 0.0, held: None }
    }

    /// A step of `seconds`. `ground` gives the field of a part of the step: from its first moment to its last, in seconds since the start.
    pub fn step<G: Ground>(&mut self, law: &Law, seconds: f64, mut ground: impl FnMut(f64, f64) -> G) {
        let h = seconds / f64::from(law.substeps);
        let start = self.time;
        for part in 0..law.substeps {
            let from = start + h * f64::from(part);
            let ground = ground(from, from + h);
            let lists = meet::neighbours(&mut self.balls);
            let arrivals: Vec<_> = self.balls.iter().map(|ball| ball.velocity).collect();
            for _ in 0..MEETINGS {
                self.balls = meet::meet(&self.balls, &lists, &arrivals, law, h);
            }
            for (i, ball) in self.balls.iter_mut().enumerate() {
                let held = self.held.filter(|(index, _)| *index == i);
                if let Some((_, place)) = held {
                    travel::pull(ball, place);
                }
                // A ball that is held does not bounce.
                let restitution = if held.is_some() { 0.0 } else { law.restitution };
                travel::travel(ball, &Law { restitution, ..*law }, &ground, h);
            }
        }
        self.time = start + seconds;
    }

    /// A step over a scene's field from one moment to another; an error where the field has too many operations for the processor.
    pub fn step_scene(&mut self, compiled: &Compiled, before: &Live, now: &Live) -> Result<(), TooLarge> {
        let law = compiled.law(now);
        let compiled = compiled.ground();
        let moves = compiled.field_moves() && compiled.uniform_bytes(before, [0.0; 3]) != compiled.uniform_bytes(now, [0.0; 3]);
        let seconds = now.time - before.time;
        // Two moments are computed at first, so that what fails does so before anything has moved.
        let whole = Field::new(compiled, now, moves.then_some(before))?;
        let start = self.time;
        self.step(&law, seconds, |from, to| {
            let at = |time: f64| before.between(now, ((time - start) / seconds).clamp(0.0, 1.0));
            let part = moves.then(|| Field::new(compiled, &at(to), Some(&at(from)))).and_then(Result::ok);
            part.unwrap_or_else(|| whole.clone())
        });
        Ok(())
    }

    /// Kinetic energy of motion and spin, and energy of place, for each unit of mass of a ball of radius 1.
    pub fn energy(&self, law: &Law) -> f64 {
        let of = |b: &Ball| {
            let motion = 0.5 * dot(b.velocity, b.velocity) + 0.2 * b.radius * b.radius * dot(b.spin, b.spin);
            b.mass() * (motion + dot(scale(law.gravity, -1.0), b.position))
        };
        self.balls.iter().map(of).sum()
    }
}
