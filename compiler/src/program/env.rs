//! Where an expression stands: the names that it sees, and whether there is a point.

use crate::graph::NodeList;
use crate::program::value::Value;
use std::rc::Rc;
use std::sync::Arc;

/// An error has been reported; what depends on it is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stop;

/// A value, or an error that has been reported.
pub type Elaborated<T> = Result<T, Stop>;

/// Local names, newest first.
pub struct Scope {
    pub(super) name: Arc<str>,
    value: Value,
    /// In a claim the name of an argument is its constant, and this is the argument.
    argument: Option<Value>,
    pub(super) outer: Option<Rc<Scope>>,
}

/// Where an expression stands.
#[derive(Clone)]
pub struct Env {
    /// Which text's names it sees.
    pub module: usize,
    /// Local names.
    pub scope: Option<Rc<Scope>>,
    /// `p`, where there is one: two or three coordinates.
    pub point: Option<NodeList>,
    /// Whether `normal` can be read.
    pub normal: bool,
}

impl Env {
    /// The top of a text.
    pub fn top(module: usize) -> Self {
        Self { module, scope: None, point: None, normal: false }
    }

    /// With one more local name.
    pub fn with(&self, name: &Arc<str>, value: Value) -> Self {
        self.clone().and(name, value)
    }

    /// This with one more local name.
    pub fn and(mut self, name: &Arc<str>, value: Value) -> Self {
        let outer = self.scope.take();
        self.scope = Some(Rc::new(Scope { name: name.clone(), value, argument: None, outer }));
        self
    }

    /// This with the constant of one more argument in a claim, and the argument itself.
    pub fn and_argument(mut self, name: &Arc<str>, constant: Value, argument: Value) -> Self {
        let outer = self.scope.take();
        self.scope = Some(Rc::new(Scope { name: name.clone(), value: constant, argument: Some(argument), outer }));
        self
    }

    /// With another `p`.
    pub fn at(&self, point: Option<NodeList>) -> Self {
        Self { point, ..self.clone() }
    }

    fn scopes(&self) -> impl Iterator<Item = &Scope> {
        std::iter::successors(self.scope.as_deref(), |s| s.outer.as_deref())
    }

    pub(super) fn local(&self, name: &str) -> Option<&Value> {
        self.scopes().find(|s| &*s.name == name).map(|s| &s.value)
    }

    /// The value of an argument in a claim.
    pub(super) fn argument(&self, name: &str) -> Option<&Value> {
        self.scopes().filter(|s| &*s.name == name).find_map(|s| s.argument.as_ref())
    }
}
