//! A ball and the numbers of a step, as `state.wgsl` declares them.

use bytemuck::{Pod, Zeroable};
use surefoot_compiler::physics::{Ball, State};

/// The numbers of a step, as `state.wgsl` declares them.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Step {
    pub gravity: [f32; 3],
    pub h: f32,
    pub low: [f32; 3],
    pub restitution: f32,
    pub high: [f32; 3],
    pub friction: f32,
    pub rolling: f32,
    pub rest: f32,
    pub extent: f32,
    pub side: f32,
    pub count: u32,
    pub mask: u32,
    pub walls: u32,
    pub moves: u32,
    pub place: [f32; 3],
    pub held: u32,
}

// How the field came to be as it is, as `state.wgsl` says.
pub(super) const STILL: u32 = 0;
pub(super) const BY_HAND: u32 = 1;
pub(super) const ANOTHER: u32 = 2;
pub(super) const BY_TIME: u32 = 3;

/// A ball, as `state.wgsl` declares it.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Cell {
    pub position: [f32; 3],
    pub radius: f32,
    pub velocity: [f32; 3],
    pub word: u32,
    pub spin: [f32; 3],
    pub quiet: f32,
    pub anchor: [f32; 3],
    pub touching: u32,
}

/// Bytes of a ball in [`Physics::buffer`](crate::physics::Physics::buffer).
pub const BALL_SIZE: u64 = size_of::<Cell>() as u64;

const ASLEEP: u32 = 1 << 16;
const GONE: u32 = 1 << 17;
const GROUNDED: u32 = 1 << 18;

impl Cell {
    pub fn of(ball: &Ball) -> Self {
        let narrow = |v: [f64; 3]| v.map(|c| c as f32);
        let state = match ball.state {
            State::Awake => 0,
            State::Asleep => ASLEEP,
            State::Gone => GONE,
        };
        Self {
            position: narrow(ball.position),
            radius: ball.radius as f32,
            velocity: narrow(ball.velocity),
            word: ball.group & 0xffff | state | if ball.grounded { GROUNDED } else { 0 },
            spin: narrow(ball.spin),
            quiet: ball.quiet as f32,
            anchor: narrow(ball.anchor),
            touching: ball.touching,
        }
    }

    pub fn ball(&self) -> Ball {
        let wide = |v: [f32; 3]| v.map(f64::from);
        Ball {
            position: wide(self.position),
            radius: f64::from(self.radius),
            velocity: wide(self.velocity),
            spin: wide(self.spin),
            group: self.word & 0xffff,
            state: match self.word {
                word if word & GONE != 0 => State::Gone,
                word if word & ASLEEP != 0 => State::Asleep,
                _ => State::Awake,
            },
            quiet: f64::from(self.quiet),
            anchor: wide(self.anchor),
            touching: self.touching,
            grounded: self.word & GROUNDED != 0,
        }
    }
}
