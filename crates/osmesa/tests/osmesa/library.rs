//! The library as a file and as a part of a process: what it exports and needs, threads, forks,
//! endings, wild calls.

use crate::common::{ours, run, runner};
use std::process::Command;

/// Runs a mode of the runner with our library.
fn lifecycle(mode: &str, threads: Option<&str>) {
    let mut command = runner();
    if let Some(threads) = threads {
        command.env("VITRAL_THREADS", threads);
    }
    let ended = run(command.args(["--lifecycle", mode]).arg(ours()));
    assert!(ended.fine, "{}", ended.errors);
}

#[test]
fn a_forked_process_draws() {
    for threads in ["1", "4"] {
        lifecycle("fork", Some(threads));
        lifecycle("fork-while-drawing", Some(threads));
    }
}

#[test]
fn each_thread_has_its_contexts() {
    lifecycle("threads", None);
    lifecycle("threads", Some("3"));
}

#[test]
fn contexts_that_look_up_one_shadow_map_do_not_wait_for_each_other() {
    for threads in ["1", "2", "8"] {
        lifecycle("shared-map", Some(threads));
    }
}

#[test]
fn a_context_moves_from_thread_to_thread() {
    lifecycle("moved", None);
}

#[test]
fn contexts_and_frames_leave_nothing_behind() {
    for threads in ["1", "3"] {
        lifecycle("growth", Some(threads));
    }
}

#[test]
fn a_context_destroyed_elsewhere_lives_until_it_is_let_go() {
    lifecycle("destroyed-elsewhere", None);
}

#[test]
fn a_buffer_that_is_gone_is_left_alone() {
    lifecycle("buffer-gone", None);
}

#[test]
fn a_process_ends_with_work_pending() {
    lifecycle("exit", Some("4"));
}

#[test]
fn a_process_ends_while_a_thread_draws() {
    lifecycle("exit-beside-thread", Some("4"));
}

#[test]
fn the_library_can_be_closed() {
    lifecycle("close", Some("4"));
}

#[test]
fn the_debug_callback_may_call_opengl() {
    lifecycle("callback", None);
}

#[test]
fn osmesa_functions_answer_as_documented() {
    lifecycle("functions", None);
}

#[test]
fn attributes_are_checked() {
    lifecycle("attributes", None);
}

#[test]
fn no_function_takes_the_process_down() {
    lifecycle("wild", None);
}

#[test]
fn errors_are_told_on_request() {
    let mut command = runner();
    command.env("VITRAL_GL_DEBUG", "1").args(["--lifecycle", "attributes"]).arg(ours());
    let ended = run(&mut command);
    assert!(ended.fine && ended.errors.contains("core"), "{}", ended.errors);
    let quiet = run(runner().args(["--lifecycle", "functions"]).arg(ours()));
    assert_eq!(quiet.errors, "");
    // A context that is refused is told always, with what to do.
    let refused = run(runner().args(["--lifecycle", "compatible"]).arg(ours()));
    assert!(refused.fine && refused.errors.contains("VITRAL_GL_COMPAT=2.1"), "{}", refused.errors);
    assert_eq!(refused.errors.lines().count(), 1);
}

#[test]
fn contexts_that_do_not_share_have_names_of_their_own() {
    lifecycle("names", None);
}

#[test]
fn signals_belong_to_the_program() {
    for threads in ["1", "4"] {
        lifecycle("signals", Some(threads));
    }
}

#[test]
fn pictures_do_not_depend_on_the_callers_floating_point_environment() {
    for threads in ["1", "4"] {
        lifecycle("floating-point", Some(threads));
    }
}

#[test]
fn a_freed_buffer_costs_its_picture() {
    lifecycle("buffer-freed", None);
}

#[test]
fn memory_that_cannot_be_had_is_an_error() {
    lifecycle("out-of-memory", Some("1"));
}

#[test]
fn draws_that_nobody_waits_for_take_little_memory() {
    for threads in ["1", "4"] {
        lifecycle("nobody-waits", Some(threads));
    }
}

#[test]
fn functions_beyond_1_5_are_not_handed_out() {
    lifecycle("procedures", None);
}

#[test]
fn contexts_of_2_1_are_given_on_request() {
    let mut command = runner();
    command.env("VITRAL_GL_COMPAT", "2.1").args(["--lifecycle", "compatible"]).arg(ours());
    let ended = run(&mut command);
    assert!(ended.fine && ended.errors.is_empty(), "{}", ended.errors);
}

#[test]
fn destructors_of_a_thread_find_its_context() {
    lifecycle("thread-end", None);
}

#[test]
fn draws_that_wait_keep_the_texels_they_saw() {
    lifecycle("part-of-a-texture", None);
}

/// Runs a tool of the binutils on the library.
fn tool(name: &str, options: &[&str]) -> Option<String> {
    let output = Command::new(name)
        .args(options)
        .arg(ours())
        .output()
        .ok()
        .filter(|output| output.status.success());
    if output.is_none() {
        println!("skipped: {name} is not installed (Debian: binutils)");
    }
    output.map(|output| String::from_utf8_lossy(&output.stdout).into_owned())
}

#[test]
fn exactly_the_functions_are_exported() {
    let Some(symbols) = tool("nm", &["-D", "--defined-only"]) else { return };
    let names: Vec<&str> =
        symbols.lines().filter_map(|line| line.split_whitespace().last()).collect();
    let others: Vec<_> = names
        .iter()
        .filter(|name| !name.starts_with("gl") && !name.starts_with("OSMesa"))
        .collect();
    assert!(others.is_empty(), "{others:?}");
    assert_eq!(names.iter().filter(|name| name.starts_with("OSMesa")).count(), 13);
    // The words of the tables that the functions are made of.
    let tables =
        [include_str!("../../src/entry_points.rs"), include_str!("../../src/unsupported.rs")];
    let api = include_str!("../../src/api.rs")
        .split_once("procedures! {\n")
        .and_then(|(_, rest)| rest.split_once('}'));
    let functions =
        tables.into_iter().flat_map(str::split_whitespace).filter(|word| word.starts_with("gl"));
    let logs = include_str!("../../src/shader_logs.rs")
        .lines()
        .filter(|line| line.ends_with(" }") && line.contains("! { gl"));
    let logs = logs.flat_map(str::split_whitespace).filter(|word| word.starts_with("gl"));
    let by_name = "OSMesaGetProcAddress";
    assert!(
        include_str!("../../src/procedures.rs").contains(&format!("procedures! {{ {by_name} }}"))
    );
    let mut expected: Vec<&str> =
        functions.chain(api.unwrap().0.split_whitespace()).chain([by_name]).chain(logs).collect();
    let mut found = names;
    expected.sort_unstable();
    found.sort_unstable();
    assert_eq!(found, expected);
}

#[test]
fn it_needs_the_c_library_alone() {
    let Some(dynamic) = tool("readelf", &["-d"]) else { return };
    assert!(dynamic.contains("soname: [libOSMesa.so.8]"), "{dynamic}");
    for line in dynamic.lines().filter(|line| line.contains("(NEEDED)")) {
        let known = ["libc.so", "libm.so", "libgcc_s.so", "ld-linux"];
        assert!(known.iter().any(|name| line.contains(name)), "{line}");
    }
}
