//! Balls, and what a scene says of them at one moment.

use crate::vector::{Vec3, length};

/// The most balls of a scene.
pub const MOST_BALLS: u32 = 1 << 20;

/// The most parts of a step.
pub const MOST_SUBSTEPS: u32 = 64;

/// How often two balls that touch are looked at in a part of a step.
pub const MEETINGS: u32 = 12;

/// The most neighbours of a ball that are looked at.
pub const NEIGHBOURS: usize = 24;

/// How far apart two balls still count as neighbours, in parts of the sum of their radii.
pub const NEAR_BALLS: f64 = 1.05;

/// How often a ball looks at the field in a part of a step.
pub const LOOKS: u32 = 48;

/// How often it is put out of what it moved into at the end of a part of a step.
pub const SETTLES: u32 = 4;

/// A contact is met to this part of the radius.
pub const NEAR: f64 = 2e-4;

/// How long a ball must keep its place before it sleeps, in seconds.
pub const PATIENCE: f64 = 0.5;

/// A ball that moved by less than this part of its radius has kept its place.
pub const PLACE: f64 = 0.02;

/// The numbers of a block `physics` at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Law {
    /// Acceleration.
    pub gravity: Vec3,
    /// Speed after a bounce over speed before, 0 to 1.
    pub restitution: f64,
    /// Coulomb's coefficient.
    pub friction: f64,
    /// The force that brakes a rolling ball, over the force that presses it.
    pub rolling: f64,
    /// Parts of a step.
    pub substeps: u32,
    /// Least and greatest corner of a box that no ball leaves.
    pub walls: Option<[Vec3; 2]>,
    /// Radius about the origin beyond which a ball is gone.
    pub extent: f64,
}

impl Law {
    /// The speed across a surface below which a ball does not bounce: twice what a part of a step of `h` seconds adds.
    pub fn rest(&self, h: f64) -> f64 {
        2.0 * length(self.gravity) * h
    }
}

/// The numbers of a block `balls` at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Its name.
    pub name: String,
    /// How many.
    pub count: u32,
    /// Least and greatest radius.
    pub radius: [f64; 2],
    /// Least and greatest corner of the box in which they begin.
    pub spawn: [Vec3; 2],
    /// With which velocity.
    pub velocity: Vec3,
    /// What chance is made of.
    pub seed: u32,
    /// Linear colour, emission, roughness, metallic, reflectivity.
    pub look: [f64; 9],
    /// The speed from which on balls are red; none where their colour is the material's.
    pub red_at: Option<f64>,
}

impl Group {
    /// The group but for its looks: where two are alike in this, the same balls begin.
    pub fn beginning(&self) -> Self {
        Self { name: String::new(), look: [0.0; 9], red_at: None, ..self.clone() }
    }
}

/// One ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Its centre.
    pub position: Vec3,
    /// Its radius.
    pub radius: f64,
    /// Velocity of the centre.
    pub velocity: Vec3,
    /// Angular velocity, radians a second.
    pub spin: Vec3,
    /// Index of its group.
    pub group: u32,
    /// What it does.
    pub state: State,
    /// Since when it has kept its place, in seconds.
    pub quiet: f64,
    /// The place.
    pub anchor: Vec3,
    /// How many balls touch it; of one that sleeps, how many did when it fell asleep.
    pub touching: u32,
    /// Whether it touches the field.
    pub grounded: bool,
}

/// What a ball does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// It moves.
    Awake,
    /// It rests and is not computed.
    Asleep,
    /// It left the scene.
    Gone,
}

impl Ball {
    /// A ball that stands still.
    pub fn at(position: Vec3, radius: f64) -> Self {
        Self {
            position,
            radius,
            velocity: [0.0; 3],
            spin: [0.0; 3],
            group: 0,
            state: State::Awake,
            quiet: 0.0,
            anchor: position,
            touching: 0,
            grounded: false,
        }
    }

    /// Its mass, in that of a ball of radius 1.
    pub fn mass(&self) -> f64 {
        self.radius * self.radius * self.radius
    }
}
