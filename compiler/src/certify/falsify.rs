//! Quick: looks for a sign change within claimed bounds, sixteen probes at once. It can't prove a bound; a wrong one does not pass it
//! for long.

use crate::evaluate::Evaluator;

/// A claim that the field keeps its sign in the open ball about a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Claim {
    /// The ball's centre.
    pub point: [f64; 3],
    /// The ball's radius.
    pub radius: f64,
    /// The field at the centre.
    pub field: f64,
}

/// A sign change within a claimed ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Violation {
    /// Which claim.
    pub claim: usize,
    /// Where in the ball the field has the other sign.
    pub at: [f64; 3],
    /// The field there.
    pub field: f64,
}

/// Values closer to zero than this count as zero: rounding may give them either sign.
const NOTHING: f64 = 1e-7;

/// Looks along directions for places within the claimed balls where the field has another sign than at the centre.
///
/// `evaluator` computes the field as its first formula. `directions` is asked for each probe's direction, of length one; each claim is
/// probed along `count` of them, at each of the `parts` of its radius (0 to 1). No point farther from the origin than `extent` is
/// looked at: nothing is claimed there. Answers every sign change, in the order of the claims.
pub fn falsify(
    evaluator: &mut Evaluator<'_>,
    claims: &[Claim],
    mut directions: impl FnMut() -> [f64; 3],
    count: usize,
    parts: &[f64],
    extent: f64,
) -> Vec<Violation> {
    let mut probes: Vec<(usize, [f64; 3])> = Vec::with_capacity(BATCH + parts.len() * count);
    let mut points = Vec::with_capacity(probes.capacity());
    let mut found = Vec::new();
    let mut flush = |probes: &mut Vec<(usize, [f64; 3])>| {
        points.clear();
        points.extend(probes.iter().map(|p| p.1));
        evaluator.at(&points, &[], |k, values| {
            let (Some(&(claim, at)), Some(&field)) = (probes.get(k), values.first()) else { return };
            let Some(claimed) = claims.get(claim) else { return };
            if field * claimed.field < 0.0 && field.abs() > NOTHING && claimed.field.abs() > NOTHING {
                found.push(Violation { claim, at, field });
            }
        });
        probes.clear();
    };
    for (i, claim) in claims.iter().enumerate() {
        for _ in 0..count {
            let direction = directions();
            for part in parts {
                let mut at = claim.point;
                at.iter_mut().zip(direction).for_each(|(x, d)| *x += part * claim.radius * d);
                if at.iter().map(|x| x * x).sum::<f64>() < extent * extent {
                    probes.push((i, at));
                }
            }
        }
        if probes.len() >= BATCH {
            flush(&mut probes);
        }
    }
    flush(&mut probes);
    found
}

/// Probes that are collected before they are computed.
const BATCH: usize = 4096;
