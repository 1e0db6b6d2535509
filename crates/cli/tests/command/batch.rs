//! `vitral batch`: nothing lost, nothing done twice, whatever happens to it.

use super::{Folder, code, errors};
use std::collections::BTreeSet;
use std::time::Duration;

/// Lines of jobs that make small pictures, `count` of each model.
fn jobs(models: &[&str], count: usize) -> String {
    let line = |(model, i): (&&str, usize)| {
        let name = model.trim_start_matches("builtin:");
        let view = 20 * i;
        format!(
            "{{\"model\": \"{model}\", \"output\": \"out/{name}-{i}.png\", \"options\": {{\"resolution\": \"40x30\", \"samples\": 1, \
             \"camera-azimuth-angle\": {view}}}}}\n"
        )
    };
    models.iter().flat_map(|model| (0..count).map(move |i| (model, i))).map(line).collect()
}

/// The lines that a run prints, by their status.
fn statuses(folder: &Folder, arguments: &[&str]) -> (i32, Vec<serde_json::Value>) {
    let output = folder.run(&[&["batch", "jobs.jsonl", "--json"], arguments].concat());
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    let lines = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    (code(&output), lines)
}

fn count(lines: &[serde_json::Value], status: &str) -> usize {
    lines.iter().filter(|line| line["status"] == status).count()
}

/// The outputs that the record has.
fn recorded(folder: &Folder) -> Vec<serde_json::Value> {
    let text = String::from_utf8(folder.read("jobs.done.jsonl")).unwrap();
    text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect()
}

#[test]
fn a_batch_makes_what_the_command_makes_and_goes_on_where_it_was() {
    let folder = Folder::new("batch");
    folder.file("a.obj", super::TRIANGLE);
    let others = concat!(
        "{\"model\": \"a.obj\", \"output\": \"out/a.png\", \"id\": \"own\", \"options\": {\"resolution\": [40, 30]}}\n",
        "{\"model\": \"builtin:cubs\", \"output\": \"cubs.svg\"}\n",
        "{\"model\": \"none.obj\", \"output\": \"out/n.png\", \"id\": \"missing\"}\n",
        "{\"model\": \"a.obj\", \"output\": \"out/o.png\", \"options\": {\"samples\": 0}, \"id\": \"odd\"}\n",
    );
    folder.file("jobs.jsonl", jobs(&["builtin:cubs", "builtin:sphere"], 3) + others);
    let (exit, lines) = statuses(&folder, &["--jobs", "2", "--shading", "flat"]);
    assert_eq!(
        (exit, lines.len(), count(&lines, "done"), count(&lines, "failed")),
        (1, 10, 8, 2),
        "{lines:?}"
    );
    let failed = |id: &str| lines.iter().find(|line| line["id"] == id).unwrap()["code"].clone();
    assert_eq!([failed("missing"), failed("odd")], [3, 2]);

    // Each is what the command writes by itself.
    let alone =
        ["render", "builtin:cubs", "--shading", "flat", "--resolution", "40x30", "--samples", "1"];
    let alone =
        folder.run(&[&alone[..], &["--camera-azimuth-angle", "20", "-o", "alone.png"]].concat());
    assert_eq!(code(&alone), 0, "{}", errors(&alone));
    assert_eq!(folder.read("alone.png"), folder.read("out/cubs-1.png"));
    assert!(
        folder.read("cubs.svg").starts_with(b"<?xml")
            || folder.read("cubs.svg").starts_with(b"<svg")
    );

    // Nothing is done twice, but for what changes.
    let (_, lines) = statuses(&folder, &["--shading", "flat"]);
    assert_eq!(
        [count(&lines, "skipped"), count(&lines, "done"), count(&lines, "failed")],
        [8, 0, 2]
    );
    std::fs::remove_file(folder.0.join("out/sphere-2.png")).unwrap();
    folder.file("a.obj", super::TRIANGLE.replace("0 1 0", "0 2 0"));
    let (_, lines) = statuses(&folder, &["--shading", "flat", "--dry-run"]);
    let waiting: Vec<_> =
        lines.iter().filter(|line| line["status"] == "waiting").map(|line| &line["id"]).collect();
    assert_eq!(waiting, ["line 6", "own", "missing", "odd"]);
    let (_, lines) = statuses(&folder, &["--shading", "flat"]);
    assert_eq!(count(&lines, "done"), 2);
    // Other options for all are other jobs.
    let (_, lines) = statuses(&folder, &["--dry-run"]);
    assert_eq!(count(&lines, "skipped"), 1, "the drawing has no shading: {lines:?}");
    let stopped = folder.run(&["batch", "jobs.jsonl", "--fail-fast", "--jobs", "1"]);
    assert_eq!(code(&stopped), 1);
}

#[test]
fn a_batch_that_is_killed_fifty_times_ends_complete() {
    let folder = Folder::new("batch-killed");
    folder.file("jobs.jsonl", jobs(&["builtin:cubs", "builtin:sphere", "builtin:scene0"], 8));
    let mut wait = 1u64;
    for _ in 0..50 {
        let mut child = folder.command(&["batch", "jobs.jsonl", "--quiet"]).spawn().unwrap();
        // Some way into it, at another place each time.
        wait = wait * 7919 % 10007;
        std::thread::sleep(Duration::from_millis(wait % 120));
        let _ = child.kill();
        child.wait().unwrap();
        // A redone job must not be in the way: forget one picture now and then.
        if wait.is_multiple_of(5) {
            let _ = std::fs::remove_file(folder.0.join("out/cubs-0.png"));
        }
    }
    // Its processes end with it.
    std::thread::sleep(Duration::from_millis(500));
    let (exit, lines) = statuses(&folder, &[]);
    assert_eq!((exit, lines.len(), count(&lines, "failed")), (0, 24, 0), "{lines:?}");
    let (_, lines) = statuses(&folder, &[]);
    assert_eq!(count(&lines, "skipped"), 24);
    let outputs: BTreeSet<String> = recorded(&folder)
        .iter()
        .flat_map(|entry| entry["outputs"].as_object().unwrap().keys().cloned().collect::<Vec<_>>())
        .collect();
    assert_eq!(outputs.len(), 24);
    for output in &outputs {
        assert!(folder.read(output).ends_with(b"IEND\xaeB`\x82"), "{output} is whole");
    }
}

#[test]
fn parts_of_a_batch_are_the_batch() {
    let folder = Folder::new("batch-parts");
    folder.file("jobs.jsonl", jobs(&["builtin:cubs"], 9));
    let mut done = 0;
    for part in ["1/3", "2/3", "3/3"] {
        let (exit, lines) = statuses(&folder, &["--shard", part]);
        assert_eq!(exit, 0);
        done += count(&lines, "done");
    }
    assert_eq!(done, 9);
    let (_, lines) = statuses(&folder, &[]);
    assert_eq!(count(&lines, "skipped"), 9);
    assert_eq!(code(&folder.run(&["batch", "jobs.jsonl", "--shard", "0/3"])), 2);
}

#[test]
fn files_that_match_are_jobs_and_none_write_over_each_other() {
    let folder = Folder::new("batch-glob");
    std::fs::create_dir_all(folder.0.join("parts/more")).unwrap();
    for name in ["parts/a.obj", "parts/more/b.obj"] {
        folder.file(name, super::TRIANGLE);
    }
    let arguments =
        ["batch", "--glob", "parts/**/*.obj", "-o", "thumbs/{model}.png", "--resolution", "40x30"];
    let output = folder.run(&arguments);
    assert_eq!(code(&output), 0, "{}", errors(&output));
    assert!(
        folder.has("thumbs/a.png") && folder.has("thumbs/b.png") && folder.has("batch.done.jsonl")
    );
    assert!(errors(&output).contains("2 jobs: 2 done, 0 skipped, 0 failed"), "{}", errors(&output));
    folder.file("parts/more/a.obj", super::TRIANGLE);
    let twice = folder.run(&arguments);
    assert!(
        code(&twice) == 2 && errors(&twice).contains("both write thumbs/a.png"),
        "{}",
        errors(&twice)
    );
    let none = folder.run(&["batch", "--glob", "*.stl", "-o", "{model}.png"]);
    assert!(code(&none) == 3 && errors(&none).contains("no file matches"), "{}", errors(&none));
}

#[cfg(target_os = "linux")]
#[test]
fn full_disks_odd_places_and_dead_processes_cost_one_job() {
    let folder = Folder::new("batch-trouble");
    folder.file("taken", "a file");
    let trouble = concat!(
        "{\"model\": \"builtin:cubs\", \"output\": \"/dev/full\", \"options\": {\"format\": \"png\", \"resolution\": \"40x30\"}, \"id\": \"full\"}\n",
        "{\"model\": \"builtin:cubs\", \"output\": \"taken/x.png\", \"id\": \"place\"}\n",
        "{\"model\": \"builtin:teapot\", \"output\": \"slow.png\", \"id\": \"slow\", \"options\": {\"resolution\": \"4000x4000\", \"samples\": 16}}\n",
    );
    folder.file("jobs.jsonl", trouble.to_owned() + &jobs(&["builtin:sphere"], 3));
    let child = folder.command(&["batch", "jobs.jsonl", "--json", "--jobs", "1"]);
    let child = { child }.stdout(std::process::Stdio::piped()).spawn().unwrap();

    // End the process that does the slow job.
    let parent = child.id();
    let mut killed = false;
    for _ in 0..200 {
        std::thread::sleep(Duration::from_millis(25));
        let worker = children(parent).into_iter().find(|pid| is_at_work(*pid));
        if let Some(pid) = worker {
            std::thread::sleep(Duration::from_millis(100));
            let ended =
                std::process::Command::new("kill").args(["-9", &pid.to_string()]).status().unwrap();
            killed = ended.success();
            break;
        }
    }
    let output = child.wait_with_output().unwrap();
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    let lines: Vec<serde_json::Value> =
        text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert!(killed, "{text}");
    assert_eq!(code(&output), 1);
    let line = |id: &str| {
        lines.iter().find(|line| line["id"] == id).unwrap_or_else(|| panic!("{id}: {text}"))
    };
    assert_eq!(line("place")["code"], 5);
    assert_eq!(line("full")["status"], "failed");
    assert!(
        line("slow")["message"].as_str().unwrap().contains("brought its process down"),
        "{text}"
    );
    assert_eq!(count(&lines, "done"), 3, "{text}");
}

/// The processes that a process started.
#[cfg(target_os = "linux")]
fn children(parent: u32) -> Vec<u32> {
    let all = std::fs::read_dir("/proc").unwrap().filter_map(Result::ok);
    let pids = all.filter_map(|entry| entry.file_name().to_str()?.parse::<u32>().ok());
    let is_child = |pid: &u32| {
        let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
        let fields = stat.rsplit_once(") ").map_or("", |(_, fields)| fields);
        fields.split(' ').nth(1) == Some(&parent.to_string())
    };
    pids.filter(is_child).collect()
}

/// Whether a process has used a fifth of a second of a processor.
#[cfg(target_os = "linux")]
fn is_at_work(pid: u32) -> bool {
    let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
    let fields = stat.rsplit_once(") ").map_or("", |(_, fields)| fields);
    fields
        .split(' ')
        .nth(11)
        .and_then(|ticks| ticks.parse::<u64>().ok())
        .is_some_and(|ticks| ticks >= 20)
}
