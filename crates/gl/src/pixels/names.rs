//! Names of objects.

use crate::names::Names;

/// More names than this are not generated or read at once.
pub(crate) const MAX_NAMES: usize = 1 << 22;

/// Reserves `count` unused names.
pub(crate) fn generate<T>(names: &mut Names<T>, count: usize) -> Vec<u32> {
    let mut out = Vec::with_capacity(count);
    let last = names.last_key_value().map_or(0, |(&name, _)| name);
    // Above all names in use as long as there is room, then in the gaps.
    let mut candidate = if (u32::MAX - last) as usize > count { last } else { 0 };
    while out.len() < count {
        candidate = candidate.wrapping_add(1);
        if candidate != 0 && !names.contains_key(&candidate) {
            names.insert(candidate, None);
            out.push(candidate);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_new_even_when_the_last_is_taken() {
        let mut names: Names<()> = Names::new();
        names.insert(1, None);
        names.insert(u32::MAX, None);
        assert_eq!(generate(&mut names, 2), [2, 3]);
        names.remove(&u32::MAX);
        assert_eq!(generate(&mut names, 1), [4]);
    }
}
