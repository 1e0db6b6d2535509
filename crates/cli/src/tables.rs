//! What there is: algorithms, formats, the manual page. All of it comes from the tables that the renderer uses.

use crate::args::{Cli, ListArgs};
use crate::report::{self, Failure};
use clap::CommandFactory;
use serde_json::json;
use std::fmt::Write;
use vitral::internals::render::registry;
use vitral::internals::render::transparency::registry as transparency;
use vitral::{Coherence, Illumination, Shading};

/// `vitral algorithms`.
pub(crate) fn algorithms(args: &ListArgs) -> Result<u8, Failure> {
    if args.json {
        let visibility: Vec<_> = registry::VISIBILITY
            .iter()
            .map(|a| {
                json!({"name": a.name, "description": a.description, "source": a.source, "precision": a.precision,
                    "coherence": a.coherence.iter().map(|kind| kind.name()).collect::<Vec<_>>(), "steps": a.steps.tell()})
            })
            .collect();
        let acceleration: Vec<_> = registry::ACCELERATION
            .iter()
            .map(|a| json!({"name": a.name, "description": a.description, "source": a.source}))
            .collect();
        let shadows: Vec<_> = registry::SHADOWS
            .iter()
            .map(|s| json!({"name": s.name, "description": s.description, "source": s.source}))
            .collect();
        let global: Vec<_> = registry::GLOBALS
            .iter()
            .map(|g| json!({"name": g.name, "description": g.description, "source": g.source}))
            .collect();
        let illumination: Vec<_> =
            Illumination::ALL.iter().map(|m| json!({"name": m.name(), "description": m.description()})).collect();
        let shading: Vec<_> =
            Shading::ALL.iter().map(|(_, name, what)| json!({"name": name, "description": what})).collect();
        let models: Vec<_> = transparency::MODELS
            .iter()
            .map(|m| json!({"name": m.name, "description": m.description, "source": m.source}))
            .collect();
        let orders: Vec<_> = transparency::ORDERS
            .iter()
            .map(|o| json!({"name": o.name, "description": o.description, "source": o.source, "exact": o.exact, "needs-list": o.needs_list, "translucent": o.blurs}))
            .collect();
        let translucency: Vec<_> = transparency::TRANSLUCENCY
            .iter()
            .map(|b| json!({"global": b.global, "description": b.description, "source": b.source}))
            .collect();
        let coherence: Vec<_> = Coherence::ALL
            .iter()
            .map(|(kind, name)| json!({"name": name, "description": kind.description()}))
            .collect();
        let all = json!({"visibility": visibility, "coherence": coherence, "acceleration": acceleration, "shadows": shadows, "global": global, "illumination": illumination,
            "shading": shading, "transparency": models, "transparency-order": orders,
            "translucency": translucency});
        return report::print_json(&all).map(|()| 0);
    }
    let mut text = String::from("Visible surfaces (--visibility)\n");
    for a in registry::VISIBILITY {
        let _ = writeln!(text, "  {:<14} {} ({} precision; {})", a.name, a.description, a.precision, a.source);
    }
    text.push_str("\nCoherence that each exploits (--coherence)\n");
    for a in registry::VISIBILITY {
        let kinds: Vec<_> = a.coherence.iter().map(|kind| kind.name()).collect();
        let _ = writeln!(text, "  {:<14} {}", a.name, kinds.join(", "));
    }
    text.push_str("\nWhat the steps of each look like (--channel steps; docs/steps.md)\n");
    for a in registry::VISIBILITY {
        let _ = writeln!(text, "  {:<14} {}", a.name, a.steps.tell());
    }
    text.push_str("\nKinds of coherence\n");
    for (kind, name) in Coherence::ALL {
        let _ = writeln!(text, "  {name:<14} {}", kind.description());
    }
    text.push_str("\nStructures for rays (--acceleration)\n");
    for a in registry::ACCELERATION {
        let _ = writeln!(text, "  {:<14} {} ({})", a.name, a.description, a.source);
    }
    text.push_str("\nShadows (--shadows)\n");
    for s in registry::SHADOWS {
        let _ = writeln!(text, "  {:<14} {} ({})", s.name, s.description, s.source);
    }
    text.push_str("\nGlobal illumination (--global)\n");
    for g in registry::GLOBALS {
        let _ = writeln!(text, "  {:<14} {} ({})", g.name, g.description, g.source);
    }
    text.push_str("\nIllumination (--illumination)\n");
    for m in Illumination::ALL {
        let _ = writeln!(text, "  {:<14} {}", m.name(), m.description());
    }
    text.push_str("\nShading (--shading)\n");
    for (_, name, what) in Shading::ALL {
        let _ = writeln!(text, "  {name:<14} {what}");
    }
    text.push_str("\nTransparency (--transparency)\n");
    for m in transparency::MODELS {
        let source = if m.source.is_empty() { String::new() } else { format!(" ({})", m.source) };
        let _ = writeln!(text, "  {:<14} {}{source}", m.name, m.description);
    }
    text.push_str("\nOrders of transparency (--transparency-order)\n");
    for o in transparency::ORDERS {
        let _ = writeln!(text, "  {:<14} {} ({})", o.name, o.description, o.source);
    }
    let blurring: Vec<_> = transparency::ORDERS.iter().filter(|o| o.blurs).map(|o| o.name).collect();
    let _ = writeln!(text, "  Translucent surfaces are shown by {}; the others refuse them.", blurring.join(", "));
    text.push_str("\nTranslucent surfaces (--material NAME.transmission=translucent), by --global\n");
    for b in transparency::TRANSLUCENCY {
        let _ = writeln!(text, "  {:<14} {} ({})", b.global, b.description, b.source);
    }
    report::print(text.as_bytes()).map(|()| 0)
}

/// `vitral formats`: file formats and built-in scenes.
pub(crate) fn formats(args: &ListArgs) -> Result<u8, Failure> {
    let rows = vitral::internals::io::formats();
    let kind = |row: &vitral::internals::io::FormatRow| format!("{:?}", row.kind).to_lowercase();
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
            .map(|(name, about)| json!({"name": format!("builtin:{name}"), "description": about}))
            .collect();
        return report::print_json(&json!({"formats": list, "builtin": builtin})).map(|()| 0);
    }
    let mut text = String::new();
    for r in &rows {
        let ways = match (r.read, r.write) {
            (true, true) => "read, written",
            (true, false) => "read",
            _ => "written",
        };
        let extensions = r.extensions.iter().map(|e| format!(".{e}")).collect::<Vec<_>>().join(" ");
        let _ = writeln!(text, "{:<12} {:<14} {:<8} {:<14} {}", r.name, extensions, kind(r), ways, r.description);
    }
    text.push_str("\nScenes that need no file\n");
    for (name, about) in vitral::builtin_names() {
        let _ = writeln!(text, "  {:<30} {about}", format!("builtin:{name}"));
    }
    report::print(text.as_bytes()).map(|()| 0)
}

/// `vitral man`: one page for the command and its verbs.
pub(crate) fn manual() -> Result<Vec<u8>, Failure> {
    let mut page = Vec::new();
    let mut command = Cli::command();
    command.build();
    let written = clap_mangen::Man::new(command.clone()).render(&mut page).and_then(|()| {
        command.get_subcommands().filter(|c| !c.is_hide_set()).try_for_each(|verb| {
            let title = format!("vitral-{}", verb.get_name());
            clap_mangen::Man::new(verb.clone()).title(title).render(&mut page)
        })
    });
    written.map_err(|e| Failure::other(format!("the manual page: {e}")))?;
    Ok(page)
}
