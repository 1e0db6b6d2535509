//! What there is: algorithms and formats. All of it comes from the tables that the renderer uses.

use crate::args::ListArgs;
use crate::report::{self, Failure};
use serde_json::json;
use std::fmt::Write;
use vitral::internals::render::registry;
use vitral::internals::render::transparency::registry as transparency;
use vitral::{Coherence, Illumination, Shading};

/// `vitral algorithms`.
pub(crate) fn algorithms(args: &ListArgs) -> Result<u8, Failure> {
    if args.json {
        report::print_json(&vitral::algorithms())?;
    } else {
        report::print(algorithms_as_text().as_bytes())?;
    }
    Ok(0)
}

/// The tables of algorithms as text, a section for each option.
fn algorithms_as_text() -> String {
    let mut text = String::new();
    add_visibility(&mut text);

    // Rays, shadows and light.
    let sourced = |description: &str, source: &str| format!("{description} ({source})");
    let rows = registry::ACCELERATION.iter().map(|a| (a.name, sourced(a.description, a.source)));
    add_section(&mut text, "Structures for rays (--acceleration)", rows);
    let rows = registry::SHADOWS.iter().map(|s| (s.name, sourced(s.description, s.source)));
    add_section(&mut text, "Shadows (--shadows)", rows);
    let rows = registry::GLOBALS
        .iter()
        .map(|g| (g.value.name(), sourced(g.value.description(), g.source)));
    add_section(&mut text, "Global illumination (--global)", rows);
    let rows = Illumination::ALL.iter().map(|m| (m.name(), m.description().to_owned()));
    add_section(&mut text, "Illumination (--illumination)", rows);
    let rows = Shading::ALL.iter().map(|(_, name, what)| (*name, (*what).to_owned()));
    add_section(&mut text, "Shading (--shading)", rows);

    // Transparent and translucent surfaces.
    let rows = transparency::MODELS.iter().map(|m| {
        let source = if m.source.is_empty() { String::new() } else { format!(" ({})", m.source) };
        (m.value.name(), format!("{}{source}", m.value.description()))
    });
    add_section(&mut text, "Transparency (--transparency)", rows);
    let rows = transparency::ORDERS.iter().map(|o| (o.name, sourced(o.description, o.source)));
    add_section(&mut text, "Orders of transparency (--transparency-order)", rows);
    let blurring: Vec<_> =
        transparency::ORDERS.iter().filter(|o| o.blurs).map(|o| o.name).collect();
    let _ = writeln!(
        text,
        "  Translucent surfaces are shown by {}; the others refuse them.",
        blurring.join(", ")
    );
    let rows =
        transparency::TRANSLUCENCY.iter().map(|b| (b.global, sourced(b.description, b.source)));
    add_section(
        &mut text,
        "Translucent surfaces (--material NAME.transmission=translucent), by --global",
        rows,
    );
    text
}

/// Adds the sections about visible-surface algorithms.
fn add_visibility(text: &mut String) {
    let all = || registry::VISIBILITY.iter();
    let rows = all()
        .map(|a| (a.name, format!("{} ({} precision; {})", a.description, a.precision, a.source)));
    add_section(text, "Visible surfaces (--visibility)", rows);
    let rows = all().map(|a| {
        let kinds: Vec<_> = a.coherence.iter().map(|kind| kind.name()).collect();
        (a.name, kinds.join(", "))
    });
    add_section(text, "Coherence that each exploits (--coherence)", rows);
    let rows = all().map(|a| (a.name, a.steps.tell().to_string()));
    add_section(text, "What the steps of each look like (--channel steps; docs/steps.md)", rows);
    let rows = Coherence::ALL.iter().map(|(kind, name)| (*name, kind.description().to_string()));
    add_section(text, "Kinds of coherence", rows);
}

/// Adds a section: a title, then a name and a text on each line. Sections are a blank line apart.
fn add_section<'a>(text: &mut String, title: &str, rows: impl Iterator<Item = (&'a str, String)>) {
    let gap = if text.is_empty() { "" } else { "\n" };
    // Writing to a String cannot fail.
    let _ = writeln!(text, "{gap}{title}");
    for (name, what) in rows {
        let _ = writeln!(text, "  {name:<14} {what}");
    }
}

/// `vitral formats`: file formats and built-in scenes.
pub(crate) fn formats(args: &ListArgs) -> Result<u8, Failure> {
    let rows = vitral::internals::io::formats();
    let kind = |row: &vitral::internals::io::FormatRow| format!("{:?}", row.kind).to_lowercase();

    // Print everything as JSON.
    if args.json {
        let list: Vec<_> = rows
            .iter()
            .map(|r| {
                json!({"name": r.name, "extensions": r.extensions, "description": r.description, "kind": kind(r),
                    "read": r.read, "write": r.write})
            })
            .collect();
        let builtin: Vec<_> = vitral::builtin_names()
            .iter()
            .map(|(name, about)| {
                let parameters: Vec<_> = vitral::builtin_parameters(name)
                    .iter()
                    .map(|p| {
                        let [least, most] = p.range;
                        json!({"name": p.name, "description": p.about, "least": least, "most": most, "default": p.default})
                    })
                    .collect();
                json!({"name": format!("builtin:{name}"), "description": about, "parameters": parameters})
            })
            .collect();
        return report::print_json(&json!({"formats": list, "builtin": builtin})).map(|()| 0);
    }

    // List the file formats.
    let mut text = String::new();
    for r in &rows {
        let ways = match (r.read, r.write) {
            (true, true) => "read, written",
            (true, false) => "read",
            _ => "written",
        };
        let extensions = r.extensions.iter().map(|e| format!(".{e}")).collect::<Vec<_>>().join(" ");
        let _ = writeln!(
            text,
            "{:<12} {:<14} {:<8} {:<14} {}",
            r.name,
            extensions,
            kind(r),
            ways,
            r.description
        );
    }

    // List the built-in scenes.
    text.push_str("\nScenes that need no file\n");
    for (name, about) in vitral::builtin_names() {
        let _ = writeln!(text, "  {:<30} {about}", format!("builtin:{name}"));
        let parameters: Vec<String> =
            vitral::builtin_parameters(name).iter().map(ToString::to_string).collect();
        if !parameters.is_empty() {
            let example = format!("builtin:{name}?{}=N", vitral::builtin_parameters(name)[0].name);
            let _ = writeln!(text, "  {:<30} {example}: {}", "", parameters.join(", "));
        }
    }
    report::print(text.as_bytes()).map(|()| 0)
}
