//! A function without what it does not need, and with `if` where its statements branched.

use super::program::{Body, Ex, Id, Loop, Step, map_of};
use rustc_hash::{FxHashMap, FxHashSet};

/// Leaves out what the value does not need, makes choices between values of what branched, and writes what has no name where it is read.
pub fn tidy(body: &mut Body, names: &mut Vec<String>) {
    let mut used = read_in(&body.value);
    body.steps = needed(std::mem::take(&mut body.steps), &mut used);
    body.steps = chosen(std::mem::take(&mut body.steps), names);
    in_place(body, names);
}

fn read_in(ex: &Ex) -> FxHashSet<Id> {
    let mut used = FxHashSet::default();
    note(ex, &mut used);
    used
}

fn note(ex: &Ex, used: &mut FxHashSet<Id>) {
    ex.each(&mut |ex| {
        if let Ex::Id(id) = ex {
            used.insert(*id);
        }
    });
}

/// The steps whose names are read.
fn needed(steps: Vec<Step>, used: &mut FxHashSet<Id>) -> Vec<Step> {
    let mut kept = Vec::new();
    for step in steps.into_iter().rev() {
        match step {
            Step::Let(id, value) => {
                if used.contains(&id) {
                    note(&value, used);
                    kept.push(Step::Let(id, value));
                }
            }
            Step::Branch { condition, yes, no, mut outs } => {
                outs.retain(|(id, _, _)| used.contains(id));
                if outs.is_empty() {
                    continue;
                }
                note(&condition, used);
                for (_, a, b) in &outs {
                    note(a, used);
                    note(b, used);
                }
                let (yes, no) = (needed(yes, used), needed(no, used));
                kept.push(Step::Branch { condition, yes, no, outs });
            }
            Step::Loop(turn) => {
                if !turn.turns.iter().any(|(id, _, _)| used.contains(id)) {
                    continue;
                }
                turn.condition.iter().chain([&turn.from, &turn.to]).for_each(|ex| note(ex, used));
                let steps = loop {
                    let before = used.len();
                    for (id, first, next) in &turn.turns {
                        if used.contains(id) {
                            note(first, used);
                            note(next, used);
                        }
                    }
                    let steps = needed(turn.steps.clone(), used);
                    if used.len() == before {
                        break steps;
                    }
                };
                let turns = turn.turns.into_iter().filter(|(id, _, _)| used.contains(id)).collect();
                kept.push(Step::Loop(Loop { steps, turns, ..turn }));
            }
        }
    }
    kept.reverse();
    kept
}

/// Choices in place of branches. What several of them need is computed before them.
fn chosen(steps: Vec<Step>, names: &mut Vec<String>) -> Vec<Step> {
    let mut made = Vec::new();
    for step in steps {
        match step {
            Step::Let(..) => made.push(step),
            Step::Loop(turn) => {
                let steps = chosen(turn.steps, names);
                made.push(Step::Loop(Loop { steps, ..turn }));
            }
            Step::Branch { condition, yes, no, outs } => {
                let (yes, no) = (chosen(yes, names), chosen(no, names));
                let condition = if outs.len() > 1 && !condition.is_short() {
                    names.push(String::new());
                    let id = names.len() as Id - 1;
                    made.push(Step::Let(id, condition));
                    Ex::Id(id)
                } else {
                    condition
                };
                let own: Vec<[Vec<Step>; 2]> = outs.iter().map(|(_, a, b)| [needed(yes.clone(), &mut read_in(a)), needed(no.clone(), &mut read_in(b))]).collect();
                let is_shared = own.iter().flatten().map(Vec::len).sum::<usize>() > yes.len() + no.len();
                if is_shared {
                    made.extend(yes);
                    made.extend(no);
                }
                for ((id, a, b), [yes, no]) in outs.into_iter().zip(own) {
                    let body = |steps: Vec<Step>, value: Ex| Box::new(Body { steps: if is_shared { Vec::new() } else { steps }, value });
                    let value = match (&a, &b) {
                        (Ex::Bool(_), _) | (_, Ex::Bool(_)) if is_shared || yes.is_empty() && no.is_empty() => super::formula::choose(condition.clone(), a, b),
                        _ => Ex::If(Box::new(condition.clone()), body(yes, a), body(no, b)),
                    };
                    made.push(Step::Let(id, value));
                }
            }
        }
    }
    made
}

/// Writes what has no name and is read once where it is read, if that is in the same loop.
fn in_place(body: &mut Body, names: &[String]) {
    let mut places: FxHashMap<Id, (usize, usize)> = FxHashMap::default();
    let mut declared: FxHashMap<Id, usize> = FxHashMap::default();
    depths(&body.steps, 0, &mut declared, &mut places);
    count(&body.value, 0, &mut declared, &mut places);
    let once = |id: &Id| {
        names.get(*id as usize).is_some_and(String::is_empty) && places.get(id).is_some_and(|(times, depth)| *times == 1 && declared.get(id).is_some_and(|at| at == depth))
    };
    let mut values: FxHashMap<Id, Ex> = FxHashMap::default();
    body.steps = moved(std::mem::take(&mut body.steps), &once, &mut values);
    body.value = inside(&body.value.map(&mut |ex| put(ex, &values)), &once);
    // A choice at the end is the value.
    if let (Some(Step::Let(id, Ex::If(..))), Ex::Id(value)) = (body.steps.last(), &body.value)
        && id == value
        && let Some(Step::Let(_, choice)) = body.steps.pop()
    {
        body.value = choice;
    }
}

fn put(ex: &Ex, values: &FxHashMap<Id, Ex>) -> Option<Ex> {
    match ex {
        Ex::Id(id) => values.get(id).cloned(),
        _ => None,
    }
}

fn moved(steps: Vec<Step>, once: &impl Fn(&Id) -> bool, values: &mut FxHashMap<Id, Ex>) -> Vec<Step> {
    let mut kept = Vec::new();
    for step in steps {
        let step = match map_of(&[step], &mut |ex| put(ex, values)).pop() {
            Some(Step::Loop(turn)) => {
                let steps = moved(turn.steps, once, values);
                let again = |ex: &Ex| ex.map(&mut |ex| put(ex, values));
                let turns = turn.turns.iter().map(|(id, first, next)| (*id, first.clone(), again(next))).collect();
                Step::Loop(Loop { steps, turns, ..turn })
            }
            Some(Step::Let(id, value)) => {
                let value = inside(&value, once);
                if once(&id) {
                    values.insert(id, value);
                    continue;
                }
                Step::Let(id, value)
            }
            Some(other) => other,
            None => continue,
        };
        kept.push(step);
    }
    kept
}

/// The same within the bodies of choices.
fn inside(ex: &Ex, once: &impl Fn(&Id) -> bool) -> Ex {
    ex.map(&mut |ex| match ex {
        Ex::If(condition, yes, no) => {
            let body = |body: &Body| {
                let mut values = FxHashMap::default();
                let steps = moved(body.steps.clone(), once, &mut values);
                let value = inside(&body.value.map(&mut |ex| put(ex, &values)), once);
                Box::new(Body { steps, value })
            };
            Some(Ex::If(Box::new(inside(condition, once)), body(yes), body(no)))
        }
        _ => None,
    })
}

fn depths(steps: &[Step], depth: usize, declared: &mut FxHashMap<Id, usize>, places: &mut FxHashMap<Id, (usize, usize)>) {
    for step in steps {
        match step {
            Step::Let(id, value) => {
                count(value, depth, declared, places);
                declared.insert(*id, depth);
            }
            Step::Branch { .. } => {}
            Step::Loop(turn) => {
                // Each loop is a depth of its own: what is written in one is not moved to another.
                let within = 1 + turn.index as usize;
                [&turn.from, &turn.to].into_iter().chain(turn.turns.iter().map(|(_, first, _)| first)).for_each(|ex| count(ex, depth, declared, places));
                depths(&turn.steps, within, declared, places);
                turn.condition.iter().chain(turn.turns.iter().map(|(_, _, next)| next)).for_each(|ex| count(ex, within, declared, places));
            }
        }
    }
}

fn count(ex: &Ex, depth: usize, declared: &mut FxHashMap<Id, usize>, places: &mut FxHashMap<Id, (usize, usize)>) {
    match ex {
        Ex::Id(id) => {
            let place = places.entry(*id).or_insert((0, depth));
            place.0 += 1;
            if place.1 != depth {
                place.1 = usize::MAX;
            }
        }
        Ex::If(condition, yes, no) => {
            count(condition, depth, declared, places);
            for body in [yes, no] {
                depths(&body.steps, depth, declared, places);
                count(&body.value, depth, declared, places);
            }
        }
        Ex::Number(_) | Ex::Bool(_) | Ex::Global(_) | Ex::Unknown(_) => {}
        Ex::Call(_, all) | Ex::Vector(all) | Ex::List(all) => all.iter().for_each(|ex| count(ex, depth, declared, places)),
        Ex::Unary(_, of) | Ex::Part(of, _) => count(of, depth, declared, places),
        Ex::Binary(_, a, b) | Ex::Index(a, b) => [a, b].into_iter().for_each(|ex| count(ex, depth, declared, places)),
    }
}
