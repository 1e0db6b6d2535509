use super::*;

/// The arrows of a crate, one `from -> to: names` each.
fn arrows_of(files: &[(&str, &str)]) -> Vec<String> {
    let text = list_with("x", &files.iter().copied().collect(), true, &[]);
    text.lines().skip(1).map(|line| line.trim().to_owned()).collect()
}

/// The arrows of a crate whose root declares `a` and `b`, and of which `b.rs` defines `f`, `T` and
/// the module `c`.
fn arrows_from(a: &str) -> Vec<String> {
    let b = "pub fn f() {} pub struct T; pub mod c { pub const N: u8 = 0; }";
    arrows_of(&[("lib.rs", "mod a; mod b; fn own() {}"), ("a.rs", a), ("b.rs", b)])
}

/// A crate in which each file but the root imports the next one, and the last one the first.
fn ring(names: &[&str]) -> Vec<(String, String)> {
    let modules = names.iter().map(|name| format!("mod {name};")).collect();
    let next = names.iter().cycle().skip(1);
    let file = |(name, next): (&&str, &&str)| {
        (format!("{name}.rs"), format!("use crate::{next}::F; pub struct F;"))
    };
    [("lib.rs".to_owned(), modules)].into_iter().chain(names.iter().zip(next).map(file)).collect()
}

/// The violations of a crate `x`.
fn check_ring(names: &[&str], exceptions: &[Exception]) -> Vec<String> {
    let files = ring(names);
    let sources = files.iter().map(|(path, text)| (path.as_str(), text.as_str())).collect();
    check_with(&BTreeMap::from([("x", sources)]), exceptions)
}

#[test]
fn imports_lead_to_the_file_that_defines() {
    for a in [
        "use crate::b::f;",
        "use super::b::f as g;",
        "use super::{b::{self, f}};",
        "use crate::{b::{c::{}, f,},};",
        "use super::b; fn g() { b::f() }",
        "use crate::b as d; fn g() { d::f() }",
        "fn g() { crate::b::f::<u8>(1) }",
        "fn g() { (0..super::b::f(1)) }",
        "fn g() { use crate::b::*; f() }",
        "mod inner { use super::super::b::*; fn g() { f } }",
        "macro_rules! m { () => { $crate::b::f() } }",
        "impl X<{ 1 }> for Y { fn g() { crate::b::f() } }",
    ] {
        assert_eq!(arrows_from(a), ["a.rs -> b.rs: f"], "{a}");
    }
    assert_eq!(
        arrows_from("use super::b::{T, c::N}; fn g() { super::own() }"),
        ["a.rs -> b.rs: N, T", "a.rs -> lib.rs: own"]
    );
}

#[test]
fn what_names_no_item_of_another_file_makes_no_arrow() {
    for a in [
        "use crate::b;",
        "use crate::b::*;",
        "use std::b::f;",
        "use ::b::f;",
        "// crate::b::f\nfn g() { \"crate::b::f\" }",
        "#[cfg(test)] mod tests { use crate::b::f; }",
        "#[cfg(test)] use crate::b::f;",
        "use crate::b::*; fn g(f: u8) { let f = x.f(); y.f; z { f: 1 } }",
        "use crate::b::*; fn f() { f() }",
        "fn g<'f>() -> impl X + use<'f> { f() }",
    ] {
        assert!(arrows_from(a).is_empty(), "{a}: {:?}", arrows_from(a));
    }
}

#[test]
fn names_that_are_handed_on_count_where_they_are_defined() {
    let files = |lib, user| {
        let parts = [
            ("a/mod.rs", "mod deep; pub use deep::F; pub use glam::*;"),
            ("a/deep.rs", "pub struct F;"),
        ];
        arrows_of(&[&[("lib.rs", lib), ("user.rs", user)], &parts[..]].concat())
    };
    let lib = "mod a; mod user; pub use a::F as G; pub use a::*;";
    for user in
        ["use crate::a::F;", "use crate::G;", "use crate::F;", "use crate::*; fn f(x: G) {}"]
    {
        assert_eq!(files(lib, user), ["user.rs -> a/deep.rs: F"], "{user}");
    }
    assert!(files(lib, "use crate::a::Vec3;").is_empty(), "another crate's name");
    assert_eq!(
        files("mod a; mod user; pub use a::F; fn f(x: F) {}", ""),
        ["lib.rs -> a/deep.rs: F"]
    );
}

#[test]
fn modules_and_items_may_share_a_name() {
    let files = [("lib.rs", "mod a; mod fog;"), ("fog.rs", "pub fn fog() {} pub fn sum() {}")];
    let with = |a| arrows_of(&[&files[..], &[("a.rs", a)]].concat());
    assert_eq!(
        with("use crate::fog::{self, fog}; fn f() { fog(); fog::sum() }"),
        ["a.rs -> fog.rs: fog, sum"]
    );
    let handing_on =
        [("lib.rs", "mod a; mod fog; pub use fog::fog;"), files[1], ("a.rs", "use crate::fog;")];
    assert_eq!(arrows_of(&handing_on), ["a.rs -> fog.rs: fog"]);
}

#[test]
fn unfinished_imports_end() {
    for text in [
        "use",
        "use a::{b;",
        "use a::{",
        "use {{a}",
        "use ::",
        "use a as",
        "use crate::a::*; use crate::*; b",
    ] {
        assert!(arrows_from(text).is_empty(), "{text}");
    }
}

#[test]
fn files_are_found_where_modules_have_them() {
    let files = [
        ("main.rs", "mod a; mod inline { pub mod c; } #[cfg(test)] mod testing;"),
        ("a.rs", "mod b; pub static S: [u8; 1] = [{ 1 }]; made! { struct M }"),
        ("a/b.rs", "use super::{S, M}; use crate::inline::c::F;"),
        ("inline/c.rs", "pub enum F {}"),
        ("testing.rs", "use crate::a::S;"),
    ];
    assert_eq!(arrows_of(&files), ["a/b.rs -> a.rs: M, S", "a/b.rs -> inline/c.rs: F"]);
}

#[test]
fn circles_have_a_limit() {
    assert!(check_ring(&["a", "b", "c"], &[]).is_empty());
    assert_eq!(
        check_ring(&["a", "b", "c", "d", "e"], &[]),
        [
            "crates/x/src: 5 files import each other: a.rs, b.rs, c.rs, d.rs and 1 more; cut the circle, 3 is the limit \
         (`cargo xtask circles x` lists the arrows)"
        ]
    );
}

#[test]
fn exceptions_hold_for_their_files() {
    let within = |paths| [Exception { folder: "x", allowed: Allowed::Within(paths), reason: "y" }];
    assert!(
        check_ring(&["a", "b", "c", "d"], &within(&["a.rs", "b.rs", "c.rs", "d.rs"])).is_empty()
    );
    assert_eq!(
        check_ring(&["a", "b", "c", "d"], &within(&["a.rs", "b.rs"])),
        [
            "crates/x/src: 4 files import each other, which only a.rs and b.rs may; cut c.rs, d.rs off (`cargo xtask circles \
         x` lists the arrows)"
        ]
    );
    assert!(is_within("a/b/c.rs", "a/") && is_within("a.rs", "a.rs"));
    assert!(!is_within("ab/c.rs", "a/") && !is_within("a.rs.rs", "a.rs"));
}

#[test]
fn circles_through_a_hub_come_apart() {
    let through =
        |files| [Exception { folder: "x", allowed: Allowed::Through(files), reason: "y" }];
    assert!(check_ring(&["a", "b", "c", "d"], &through(&["b.rs"])).is_empty());

    // A circle beside the hub is still found.
    let mut files = ring(&["a", "b", "c", "d", "e"]);
    files.push((
        "a.rs".to_owned(),
        "use crate::b::F as _; use crate::hub::F as _; pub struct F;".to_owned(),
    ));
    files.push(("hub.rs".to_owned(), "use crate::a::F as _; pub struct F;".to_owned()));
    files[0].1 += "mod hub;";
    let sources: Sources<'_> =
        files.iter().map(|(path, text)| (path.as_str(), text.as_str())).collect();
    let found = check_with(&BTreeMap::from([("x", sources)]), &through(&["hub.rs"]));
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].starts_with("crates/x/src: 5 files"), "{found:?}");
}

#[test]
fn exceptions_without_need_are_told() {
    let message = |path| {
        format!("crates/x/src: no circle needs the exception for {path}; remove it from {HERE}")
    };
    let with = |names: &[&str], allowed| {
        check_ring(names, &[Exception { folder: "x", allowed, reason: "y" }])
    };
    assert_eq!(with(&["a", "b", "c"], Allowed::Within(&["a.rs"])), [message("a.rs")]);
    assert_eq!(with(&["a", "b", "c"], Allowed::Through(&["a.rs"])), [message("a.rs")]);
    let all = Allowed::Within(&["a.rs", "b.rs", "c.rs", "d.rs", "e/"]);
    assert_eq!(with(&["a", "b", "c", "d"], all), [message("e/")]);
    let gone = Exception { folder: "gone", allowed: Allowed::Within(&["a.rs"]), reason: "y" };
    assert_eq!(
        check_with(&BTreeMap::new(), &[gone]),
        [message("a.rs").replace("crates/x/", "crates/gone/")]
    );
}

#[test]
fn the_listing_shows_circles_and_what_it_leaves_out() {
    let files = [
        ("lib.rs", "mod a; mod b;"),
        ("a.rs", "use crate::b::{g, f}; pub struct T;"),
        ("b.rs", "use crate::a::T; pub fn f() {} pub fn g() {}"),
    ];
    let list =
        |exceptions: &[Exception]| list_with("x", &files.into_iter().collect(), false, exceptions);
    assert_eq!(list(&[]), "x: a circle of 2 files\n  a.rs -> b.rs: f, g\n  b.rs -> a.rs: T\n");
    let hub =
        Exception { folder: "x", allowed: Allowed::Through(&["a.rs"]), reason: "it is central" };
    assert_eq!(list(&[hub]), "x: without the arrows to a.rs: it is central\nx: no circle\n");
}
