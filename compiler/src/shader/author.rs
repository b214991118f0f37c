//! How far the shader's own loop lets a ray step: the share of a distance that it adds to the way.

use naga::{BinaryOperator, Block, Expression, Function, Handle, Literal, MathFunction, Module, Span, Statement};
use rustc_hash::FxHashMap;

/// By what share of its value a function's caller steps, in the loops of a file, and where that is written.
pub fn steps(module: &Module) -> FxHashMap<Handle<Function>, (f64, Span)> {
    let mut found = FxHashMap::default();
    for (_, function) in module.functions.iter() {
        let mut search = Search { module, function, held: FxHashMap::default(), results: FxHashMap::default() };
        search.calls(&function.body);
        search.block(&function.body, false, &mut found);
    }
    found
}

struct Search<'m> {
    module: &'m Module,
    function: &'m Function,
    /// The variables that hold a share of what a function gave back.
    held: FxHashMap<Handle<naga::LocalVariable>, (Handle<Function>, f64)>,
    /// Which function each result is of.
    results: FxHashMap<Handle<Expression>, Handle<Function>>,
}

impl Search<'_> {
    fn calls(&mut self, block: &Block) {
        for statement in block.iter() {
            if let Statement::Call { function, result: Some(result), .. } = statement {
                self.results.insert(*result, *function);
            }
            for inner in inner(statement) {
                self.calls(inner);
            }
        }
    }

    fn block(&mut self, block: &Block, in_loop: bool, found: &mut FxHashMap<Handle<Function>, (f64, Span)>) {
        for (statement, span) in block.span_iter() {
            if let Statement::Store { pointer, value } = statement
                && let Some(variable) = self.variable(*pointer)
            {
                match self.added(variable, *value) {
                    // The first loop that goes along a ray is the one that draws; light and shadow come after it.
                    Some((function, share)) if in_loop => {
                        found.entry(function).or_insert((share, *span));
                    }
                    _ => {}
                }
                if let Some(share) = self.share(*value) {
                    self.held.insert(variable, share);
                }
            }
            for inner in inner(statement) {
                self.block(inner, in_loop || matches!(statement, Statement::Loop { .. }), found);
            }
        }
    }

    fn variable(&self, pointer: Handle<Expression>) -> Option<Handle<naga::LocalVariable>> {
        match self.of(pointer)? {
            Expression::LocalVariable(variable) => Some(*variable),
            Expression::AccessIndex { base, .. } | Expression::Access { base, .. } => self.variable(*base),
            _ => None,
        }
    }

    fn of(&self, handle: Handle<Expression>) -> Option<&Expression> {
        self.function.expressions.try_get(handle).ok()
    }

    /// The share of a function's value that is added to a variable.
    fn added(&self, variable: Handle<naga::LocalVariable>, value: Handle<Expression>) -> Option<(Handle<Function>, f64)> {
        let Expression::Binary { op: BinaryOperator::Add, left, right } = self.of(value)? else { return None };
        let is_itself = |handle| matches!(self.of(handle), Some(Expression::Load { pointer }) if self.variable(*pointer) == Some(variable));
        match (is_itself(*left), is_itself(*right)) {
            (true, false) => self.share(*right),
            (false, true) => self.share(*left),
            _ => None,
        }
    }

    /// Of which function's value an expression is a constant share; what it is multiplied with besides counts as a direction.
    fn share(&self, handle: Handle<Expression>) -> Option<(Handle<Function>, f64)> {
        match self.of(handle)? {
            Expression::CallResult(_) => Some((*self.results.get(&handle)?, 1.0)),
            Expression::AccessIndex { base, index: 0 } => self.share(*base),
            Expression::Load { pointer } => self.held.get(&self.variable(*pointer)?).copied(),
            Expression::Math { fun: MathFunction::Abs | MathFunction::Max | MathFunction::Min | MathFunction::Clamp, arg, arg1, .. } => {
                self.share(*arg).or_else(|| self.share((*arg1)?))
            }
            Expression::Binary { op: BinaryOperator::Multiply, left, right } => {
                let ((function, share), other) = match (self.share(*left), self.share(*right)) {
                    (Some(share), None) => (share, *right),
                    (None, Some(share)) => (share, *left),
                    _ => return None,
                };
                Some((function, share * self.number(other).unwrap_or(1.0)))
            }
            Expression::Binary { op: BinaryOperator::Divide, left, right } => {
                let (function, share) = self.share(*left)?;
                Some((function, share / self.number(*right)?))
            }
            _ => None,
        }
    }

    fn number(&self, handle: Handle<Expression>) -> Option<f64> {
        let literal = match self.of(handle)? {
            Expression::Literal(literal) => *literal,
            Expression::Constant(constant) => match self.module.global_expressions.try_get(self.module.constants.try_get(*constant).ok()?.init).ok()? {
                Expression::Literal(literal) => *literal,
                _ => return None,
            },
            Expression::Splat { value, .. } => return self.number(*value),
            _ => return None,
        };
        match literal {
            Literal::F32(value) => value.to_string().parse().ok(),
            Literal::F64(value) | Literal::AbstractFloat(value) => Some(value),
            Literal::I32(value) => Some(value.into()),
            Literal::AbstractInt(value) => Some(value as f64),
            _ => None,
        }
        .filter(|value: &f64| value.is_finite() && *value > 0.0)
    }
}

fn inner(statement: &Statement) -> Vec<&Block> {
    match statement {
        Statement::Block(inner) => vec![inner],
        Statement::If { accept, reject, .. } => vec![accept, reject],
        Statement::Switch { cases, .. } => cases.iter().map(|case| &case.body).collect(),
        Statement::Loop { body, continuing, .. } => vec![body, continuing],
        _ => Vec::new(),
    }
}
