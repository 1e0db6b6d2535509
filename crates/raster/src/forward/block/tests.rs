//! Tests of `block.rs`.

use super::*;

#[test]
fn depth_functions_as_bits_hold_where_they_hold() {
    use Compare::{Always, Equal, Greater, GreaterOrEqual, Less, LessOrEqual, Never, NotEqual};
    let depths = [0.0, 0.25, 0.5, 1.0, f32::NAN];
    for func in [Never, Less, Equal, LessOrEqual, Greater, NotEqual, GreaterOrEqual, Always] {
        let passing = Passing::new(func);
        for (new, old) in depths.iter().flat_map(|a| depths.iter().map(move |b| (*a, *b))) {
            let pass = passing.of(u32::from(new >= old), u32::from(new <= old)) & 1 == 1;
            assert_eq!(pass, holds(func, new, old), "{func:?} {new} {old}");
        }
    }
}
