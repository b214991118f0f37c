//! How often a loop turns.

use super::formula::{and, binary};
use super::program::{Ex, Id, Loop, Step, map_of};
use rustc_hash::FxHashMap;

/// Turns of a loop, at most.
const MOST_TURNS: u32 = 4096;

/// A loop that has a number of turns, and the name that its number of the turn takes the place of; or why none can be found. `known` has the names
/// that are numbers, `whole` those that hold whole numbers; where one of `flags` is true, the loop has ended.
pub fn count(
    index: Id,
    flags: &[Id],
    condition: Ex,
    steps: Vec<Step>,
    turns: Vec<(Id, Ex, Ex)>,
    known: &FxHashMap<Id, f64>,
    whole: &[bool],
) -> Result<(Loop, Option<Id>), String> {
    let number = |ex: &Ex| match ex {
        Ex::Number(value) => Some(*value),
        Ex::Id(id) => known.get(id).copied(),
        _ => None,
    };
    let mut branches = FxHashMap::default();
    note_branches(&steps, &mut branches);
    let stops: Vec<Ex> = turns.iter().filter(|(id, _, _)| flags.contains(id)).map(|(_, _, next)| next.clone()).collect();
    let conjuncts = conjuncts(&condition);
    for (at, conjunct) in conjuncts.iter().enumerate() {
        for (id, first, next) in &turns {
            if !conjunct.reads(*id) {
                continue;
            }
            let others = conjuncts.iter().enumerate().filter(|(i, _)| *i != at).fold(Ex::Bool(true), |all, (_, other)| and(all, other.clone()));
            let Some(next) = going_on(next, &stops, &branches).ok().flatten() else { continue };
            let step = match &next {
                Ex::Binary("+", a, b) if **a == Ex::Id(*id) => number(b),
                Ex::Binary("-", a, b) if **a == Ex::Id(*id) => number(b).map(|step| -step),
                _ => None,
            };
            let reads_others = turns.iter().any(|(other, _, _)| other != id && conjunct.reads(*other));
            if let (Some(start), false) = (number(first), reads_others)
                && let Some(count) = simulated(*id, start, &next, conjunct, known)
            {
                let Some(count) = count else { return Err(format!("this loop turns more than {MOST_TURNS} times")) };
                let end = f64::from(count);
                let is_index = step == Some(1.0) && start.fract() == 0.0;
                let (from, to) = if is_index { (start, start + end) } else { (0.0, end) };
                let Some(step) = step else {
                    // The turns are counted, and what counted them goes on as it is.
                    return Ok((made(index, Ex::Number(0.0), Ex::Number(end), others, steps, turns), None));
                };
                let value = if is_index { Ex::Id(index) } else { binary("+", Ex::Number(start), binary("*", Ex::Number(step), Ex::Id(index))) };
                let id = *id;
                let turns = replaced(&turns, id, &value);
                let (steps, others) = (map_of(&steps, &mut |ex| (*ex == Ex::Id(id)).then(|| value.clone())), others.map(&mut |ex| (*ex == Ex::Id(id)).then(|| value.clone())));
                return Ok((made(index, Ex::Number(from), Ex::Number(to), others, steps, turns), is_index.then_some(id)));
            }
            // So many turns as something says that the loop does not change.
            let is_whole = whole.get(*id as usize).copied().unwrap_or(false);
            if let (true, Some(1.0), Ex::Binary(op, a, b)) = (is_whole, step, conjunct)
                && **a == Ex::Id(*id)
                && !turns.iter().any(|(other, _, _)| b.reads(*other))
            {
                let to = match *op {
                    "<" | "!=" => (**b).clone(),
                    "<=" => binary("+", (**b).clone(), Ex::Number(1.0)),
                    _ => continue,
                };
                let (id, from, value) = (*id, first.clone(), Ex::Id(index));
                let turns = replaced(&turns, id, &value);
                let (steps, others) = (map_of(&steps, &mut |ex| (*ex == Ex::Id(id)).then(|| value.clone())), others.map(&mut |ex| (*ex == Ex::Id(id)).then(|| value.clone())));
                return Ok((made(index, from, to, others, steps, turns), Some(id)));
            }
        }
    }
    Err("it can't be found how often this loop turns at most".to_owned())
}

/// What each name that a branch gives a value is on either side, and which branch that is.
type Branches = FxHashMap<Id, (usize, [Ex; 2])>;

fn note_branches(steps: &[Step], branches: &mut Branches) {
    for step in steps {
        if let Step::Branch { yes, no, outs, .. } = step {
            note_branches(yes, branches);
            note_branches(no, branches);
            let number = branches.len() + 1;
            branches.extend(outs.iter().map(|(id, a, b)| (*id, (number, [a.clone(), b.clone()]))));
        }
    }
}

/// What a value is wherever the loop goes on: none where it never does; an error where it is not one.
fn going_on(value: &Ex, stops: &[Ex], branches: &Branches) -> Result<Option<Ex>, ()> {
    if stops.contains(&Ex::Bool(true)) {
        return Ok(None);
    }
    let of = |ex: &Ex| match ex {
        Ex::Id(id) => branches.get(id),
        _ => None,
    };
    let Some(number) = [value].into_iter().chain(stops).filter_map(of).map(|(number, _)| *number).max() else { return Ok(Some(value.clone())) };
    let on = |side: usize| {
        let of = |ex: &Ex| match of(ex) {
            Some((other, sides)) if *other == number => sides.get(side).cloned().unwrap_or(Ex::Bool(false)),
            _ => ex.clone(),
        };
        going_on(&of(value), &stops.iter().map(of).collect::<Vec<_>>(), branches)
    };
    match (on(0)?, on(1)?) {
        (Some(a), Some(b)) if a != b => Err(()),
        (a, b) => Ok(a.or(b)),
    }
}

fn made(index: Id, from: Ex, to: Ex, condition: Ex, steps: Vec<Step>, turns: Vec<(Id, Ex, Ex)>) -> Loop {
    let condition = (condition != Ex::Bool(true)).then_some(condition);
    Loop { index, from, to, condition, steps, turns }
}

/// What is replaced each turn, with something else read in place of a name.
fn replaced(turns: &[(Id, Ex, Ex)], id: Id, value: &Ex) -> Vec<(Id, Ex, Ex)> {
    turns.iter().map(|(other, first, next)| (*other, first.clone(), next.map(&mut |ex| (*ex == Ex::Id(id)).then(|| value.clone())))).collect()
}

fn conjuncts(condition: &Ex) -> Vec<Ex> {
    match condition {
        Ex::Binary("&&", a, b) => [a, b].into_iter().flat_map(|side| conjuncts(side)).collect(),
        other => vec![other.clone()],
    }
}

/// How often something can be replaced until a condition on it ends; none within where that is too often, none at all where it can't be computed.
fn simulated(id: Id, start: f64, next: &Ex, condition: &Ex, known: &FxHashMap<Id, f64>) -> Option<Option<u32>> {
    // As the GPU computes: a number that counts in tenths ends where it ends there.
    let mut value = f64::from(start as f32);
    for count in 0..=MOST_TURNS {
        match evaluate(condition, id, value, known)? {
            Evaluated::Holds(false) => return Some(Some(count)),
            Evaluated::Holds(true) => {}
            Evaluated::Number(_) => return None,
        }
        let Evaluated::Number(new) = evaluate(next, id, value, known)? else { return None };
        value = f64::from(new as f32);
    }
    Some(None)
}

enum Evaluated {
    Number(f64),
    Holds(bool),
}

fn evaluate(ex: &Ex, id: Id, value: f64, known: &FxHashMap<Id, f64>) -> Option<Evaluated> {
    let number = |ex: &Ex| match evaluate(ex, id, value, known)? {
        Evaluated::Number(value) => Some(value),
        Evaluated::Holds(_) => None,
    };
    Some(Evaluated::Number(match ex {
        Ex::Number(value) => *value,
        Ex::Id(other) if *other == id => value,
        Ex::Id(other) => *known.get(other)?,
        Ex::Unary('-', of) => -number(of)?,
        Ex::Unary('!', of) => match evaluate(of, id, value, known)? {
            Evaluated::Holds(value) => return Some(Evaluated::Holds(!value)),
            Evaluated::Number(_) => return None,
        },
        Ex::Call(name, all) => {
            let [one] = all.as_slice() else { return None };
            let one = number(one)?;
            match name.as_str() {
                "int" | "trunc" => one.trunc(),
                "floor" => one.floor(),
                _ => return None,
            }
        }
        Ex::Binary(op, a, b) => {
            let (a, b) = (number(a)?, number(b)?);
            match *op {
                "+" => f64::from((a + b) as f32),
                "-" => f64::from((a - b) as f32),
                "*" => f64::from((a * b) as f32),
                "/" => f64::from((a / b) as f32),
                "<" => return Some(Evaluated::Holds(a < b)),
                "<=" => return Some(Evaluated::Holds(a <= b)),
                ">" => return Some(Evaluated::Holds(a > b)),
                ">=" => return Some(Evaluated::Holds(a >= b)),
                "==" => return Some(Evaluated::Holds(a == b)),
                "!=" => return Some(Evaluated::Holds(a != b)),
                _ => return None,
            }
        }
        _ => return None,
    }))
}
