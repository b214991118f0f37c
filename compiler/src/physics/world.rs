//! All balls of a scene, step by step.

use super::{Ball, Ground, Law, MEETINGS, meet, travel};
use crate::reference::vector::{dot, scale};

/// Balls, and the time that passed for them.
#[derive(Clone, Debug, Default)]
pub struct World {
    /// The balls.
    pub balls: Vec<Ball>,
    /// Seconds since the start.
    pub time: f64,
}

impl World {
    /// Balls at the start.
    pub fn new(balls: Vec<Ball>) -> Self {
        Self { balls, time: 0.0 }
    }

    /// A step of `seconds`. `ground` gives the field of a part of the step: from its first moment to its last, in seconds since the start.
    pub fn step<G: Ground>(&mut self, law: &Law, seconds: f64, mut ground: impl FnMut(f64, f64) -> G) {
        let h = seconds / f64::from(law.substeps);
        let start = self.time;
        for part in 0..law.substeps {
            let from = start + h * f64::from(part);
            let ground = ground(from, from + h);
            let lists = meet::neighbours(&mut self.balls);
            for turn in 0..MEETINGS {
                self.balls = meet::meet(&self.balls, &lists, law, h, turn == 0);
            }
            for ball in &mut self.balls {
                travel::travel(ball, law, &ground, h);
            }
        }
        self.time = start + seconds;
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
