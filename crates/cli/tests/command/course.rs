//! The commands of docs/course.md, each at a small size.

use super::*;
use std::path::Path;

/// The words of a command as a shell splits them; quotes are the single ones.
fn words(line: &str) -> Vec<String> {
    let (mut words, mut quoted) = (vec![String::new()], false);
    for letter in line.chars() {
        match letter {
            '\'' => quoted = !quoted,
            ' ' if !quoted => words.push(String::new()),
            _ => words.last_mut().unwrap().push(letter),
        }
    }
    words
}

#[test]
fn every_command_of_the_course_runs() {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let text = std::fs::read_to_string(top.join("docs/course.md")).unwrap();
    let commands: Vec<&str> = text.split('`').filter(|span| span.starts_with("vitral ")).collect();
    assert!(commands.len() > 80, "{}", commands.len());
    let folder = Folder::new("course");
    for line in commands {
        let mut typed = words(line);
        typed.remove(0);
        match typed[0].as_str() {
            // It waits for a browser.
            "lab" => continue,
            // Sizes, and the pixels that are explained, are those of small pictures here.
            "render" => {
                typed
                    .iter_mut()
                    .filter(|word| *word == "512,384")
                    .for_each(|word| *word = "32,24".to_owned());
                typed.extend(SMALL.map(str::to_owned));
            }
            _ => {}
        }
        let arguments: Vec<&str> = typed.iter().map(String::as_str).collect();
        let output = folder.run(&arguments);
        assert_eq!(code(&output), 0, "{line}: {}", errors(&output));
        assert!(!errors(&output).contains("no effect"), "{line}: {}", errors(&output));
    }
}

#[test]
fn every_item_of_the_course_has_a_row() {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let text = std::fs::read_to_string(top.join("docs/course.md")).unwrap();
    let mut named = std::collections::BTreeSet::new();
    for row in text.lines().filter_map(|line| line.strip_prefix("| ")) {
        let items = row.split(" |").next().unwrap().replace(',', "");
        let items: Vec<&str> = items.split(' ').collect();
        let number = |item: &str| item.get(1..).and_then(|digits| digits.parse::<u32>().ok());
        for (at, item) in items.iter().enumerate().filter(|(_, item)| number(item).is_some()) {
            let last =
                if items.get(at + 1) == Some(&"to") { number(items[at + 2]) } else { number(item) };
            named.extend(
                (number(item).unwrap()..=last.unwrap()).map(|n| format!("{}{n}", &item[..1])),
            );
        }
    }
    for (letter, count) in [("T", 17), ("F", 27), ("L", 22), ("P", 42)] {
        let missing: Vec<_> = (1..=count)
            .map(|n| format!("{letter}{n}"))
            .filter(|item| !named.contains(item))
            .collect();
        assert!(missing.is_empty(), "{missing:?}");
    }
}
