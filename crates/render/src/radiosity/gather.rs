//! Gathering: every element asks all others what they send it, until nothing changes. The reference
//! of shooting.
//!
//! `B_i = E_i + ρ_i Σ_j F_ij B_j` is a system of linear equations. Its rows come from a hemicube on
//! each side of each element; it is solved by Gauss and Seidel's method, which takes what is new as
//! soon as it is there.
//!
//! In:   an enclosure. Out: radiosity of each side of each element.
//! Cost: a hemicube for each side, memory for all form factors, and some ten passes over them.
//! Source: \[Goral et al. 1984\], \[Cohen & Greenberg 1985\].

use super::element::{Color, FormFactors, turned};
use super::enclosure::Enclosure;
use super::hemicube::Hemicube;
use crate::Execution;
use vitral_exec::Limit;

/// Passes at most.
const MOST_PASSES: usize = 1000;

/// The rows of all sides: what each sees.
///
/// # Errors
/// A limit of the budget.
pub fn rows(
    enclosure: &Enclosure,
    hemicube: &Hemicube,
    execution: &Execution,
) -> Result<Vec<FormFactors>, Limit> {
    let row = |side: usize| {
        let element = &enclosure.elements[side / 2];
        let from = (element.center, element.normal * turned(side));
        let seen =
            hemicube.look((&enclosure.targets, &enclosure.trees), from, side / 2, execution)?;
        Ok(enclosure.sides(seen, element.center))
    };
    execution.workers.map(enclosure.emission.len(), row).into_iter().collect()
}

/// Solves the equations until no radiosity changes by more than `tolerance`.
pub fn solve(enclosure: &Enclosure, rows: &[FormFactors], tolerance: f64) -> Vec<Color> {
    let mut radiosity = enclosure.emission.clone();
    for _ in 0..MOST_PASSES {
        let mut change = 0.0f64;
        // Gather at each side what all others send, with the newest values (Gauss and Seidel).
        for (side, row) in rows.iter().enumerate() {
            let reflectance = enclosure.elements[side / 2].reflectance;
            for k in 0..3 {
                let gathered: f64 =
                    row.iter().map(|&(other, factor)| factor * radiosity[other as usize][k]).sum();
                let new = enclosure.emission[side][k] + reflectance[k] * gathered;
                change = change.max((new - radiosity[side][k]).abs());
                radiosity[side][k] = new;
            }
        }
        if change <= tolerance {
            break;
        }
    }
    radiosity
}
