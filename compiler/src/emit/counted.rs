//! The text of a module that counts the operations that it does: for a view of them, and never in a module that is handed out.

use super::translate::validate;
use naga::back::wgsl::{WriterFlags, write_string};
use naga::proc::TypeResolution;
use naga::valid::{FunctionInfo, ModuleInfo};
use naga::{AddressSpace, BinaryOperator, Block, Expression, Function, GlobalVariable, Handle, Literal, Module, Range, Scalar, Span, Statement, Type, TypeInner};

/// The variable that counts, from 0 on for each fragment or thread.
pub const COUNTER: &str = "sf_counted";

/// A text whose functions add to [`COUNTER`] the operations that they do: arithmetic, comparisons, choices and functions of numbers.
/// An operation on vectors counts once for each component. One in a branch or a loop counts each time that it is done.
/// Fails where naga can't read the text.
pub fn counted(wgsl: &str) -> Result<String, String> {
    let (mut module, info) = validate(wgsl)?;
    let number = module.types.insert(Type { name: None, inner: TypeInner::Scalar(Scalar::U32) }, Span::UNDEFINED);
    let counter = GlobalVariable { name: Some(COUNTER.to_owned()), space: AddressSpace::Private, binding: None, ty: number, init: None, memory_decorations: Default::default() };
    let counter = module.global_variables.append(counter, Span::UNDEFINED);
    let costs: Vec<Vec<u32>> = module.functions.iter().map(|(handle, function)| costs(&module, function, &info[handle])).collect();
    for ((_, function), costs) in module.functions.iter_mut().zip(&costs) {
        let mut body = std::mem::take(&mut function.body);
        count(function, &mut body, counter, costs);
        function.body = body;
    }
    let info: ModuleInfo = naga::valid::Validator::new(naga::valid::ValidationFlags::all(), naga::valid::Capabilities::empty())
        .validate(&module)
        .map_err(|e| e.to_string())?;
    write_string(&module, &info, WriterFlags::empty()).map_err(|e| e.to_string())
}

/// What each expression of a function costs.
fn costs(module: &Module, function: &Function, info: &FunctionInfo) -> Vec<u32> {
    let parts = |handle: Handle<Expression>| {
        let inner = match &info[handle].ty {
            TypeResolution::Handle(ty) => &module.types[*ty].inner,
            TypeResolution::Value(inner) => inner,
        };
        match *inner {
            TypeInner::Vector { size, .. } => u32::from(size as u8),
            TypeInner::Matrix { columns, rows, .. } => u32::from(columns as u8) * u32::from(rows as u8),
            _ => 1,
        }
    };
    let cost = |(handle, expression): (Handle<Expression>, &Expression)| match expression {
        Expression::Binary { op: BinaryOperator::LogicalAnd | BinaryOperator::LogicalOr, .. } => 0,
        Expression::Binary { .. } | Expression::Unary { .. } | Expression::Select { .. } | Expression::As { .. } | Expression::Relational { .. } => parts(handle),
        // A length or a product of vectors looks at each component.
        Expression::Math { arg, .. } => parts(handle).max(parts(*arg)),
        _ => 0,
    };
    function.expressions.iter().map(cost).collect()
}

/// Adds to the counter, in a block and those in it, before anything that may leave the block.
fn count(function: &mut Function, block: &mut Block, counter: Handle<GlobalVariable>, costs: &[u32]) {
    let mut counted = Block::with_capacity(2 * block.len());
    let mut sum = 0;
    for (mut statement, span) in std::mem::take(block).span_into_iter() {
        match &mut statement {
            Statement::Emit(range) => sum += range.clone().map(|handle| costs.get(handle.index()).copied().unwrap_or(0)).sum::<u32>(),
            Statement::Store { .. } | Statement::Call { .. } => {}
            other => {
                add(function, &mut counted, counter, std::mem::take(&mut sum));
                match other {
                    Statement::Block(inner) => count(function, inner, counter, costs),
                    Statement::If { accept, reject, .. } => {
                        count(function, accept, counter, costs);
                        count(function, reject, counter, costs);
                    }
                    Statement::Switch { cases, .. } => cases.iter_mut().for_each(|case| count(function, &mut case.body, counter, costs)),
                    Statement::Loop { body, continuing, .. } => {
                        count(function, body, counter, costs);
                        count(function, continuing, counter, costs);
                    }
                    _ => {}
                }
            }
        }
        counted.push(statement, span);
    }
    add(function, &mut counted, counter, sum);
    *block = counted;
}

/// `counter += sum`.
fn add(function: &mut Function, block: &mut Block, counter: Handle<GlobalVariable>, sum: u32) {
    if sum == 0 {
        return;
    }
    let expressions = &mut function.expressions;
    let pointer = expressions.append(Expression::GlobalVariable(counter), Span::UNDEFINED);
    let right = expressions.append(Expression::Literal(Literal::U32(sum)), Span::UNDEFINED);
    let left = expressions.append(Expression::Load { pointer }, Span::UNDEFINED);
    let value = expressions.append(Expression::Binary { op: BinaryOperator::Add, left, right }, Span::UNDEFINED);
    block.push(Statement::Emit(Range::new_from_bounds(left, value)), Span::UNDEFINED);
    block.push(Statement::Store { pointer, value }, Span::UNDEFINED);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loops_and_branches_count_what_they_do() {
        let text = counted(
            "fn f(x: f32, v: vec3f) -> f32 {
    var s = x * 2.0 + 1.0;
    if s > 3.0 { s = dot(v * s, v); } else { return s; }
    for (var i = 0u; i < 4u; i += 1u) { if s > 9.0 { break; } s += sin(s); }
    return s;
}",
        )
        .unwrap();
        // Before the branch two operations and a comparison; in it three products and a dot product of three.
        assert!(text.contains("sf_counted = (_e") && text.contains("+ 3u)") && text.contains("+ 6u)"), "{text}");
        assert!(text.contains("var<private> sf_counted: u32"), "{text}");
        assert!(validate(&text).is_ok());
        assert!(counted("fn f() {").is_err());
    }
}
