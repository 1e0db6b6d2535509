//! Which source file names items of which other.

use super::modules::{Binding, Import, Module};
use crate::check::tokens::Token;
use std::collections::{BTreeMap, BTreeSet};

/// From a file to a file, with the names that make the arrow.
pub(super) type Arrows = BTreeMap<(String, String), BTreeSet<String>>;

/// What a path leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Target<'a> {
    Module(usize),
    /// An item and the module that defines it.
    Item(usize, &'a str),
    /// Something of another crate.
    Outside,
}

/// The arrows between the files of these modules, of which the first is the root.
///
/// An arrow ends where a name is defined, not at the modules that hand it on. A `use` with a
/// visibility hands names on and makes no arrow; code that uses such a name does.
pub(super) fn arrows(modules: &[Module<'_>]) -> Arrows {
    let scope = Scope { modules };
    let mut arrows = Arrows::new();
    for (from, module) in modules.iter().enumerate() {
        let imports =
            module.imports.iter().filter(|import| !import.public).map(|import| import.path.clone());
        for path in imports.chain(named_paths(&module.code)) {
            let Some(Target::Item(definer, name)) = scope.resolve(from, &path, &mut Open::new())
            else {
                continue;
            };
            let to = &modules[definer].file;
            if *to != module.file {
                arrows
                    .entry((module.file.clone(), to.clone()))
                    .or_default()
                    .insert(name.to_owned());
            }
        }
    }
    arrows
}

/// The paths in code. A single name is a path unless it is a field, a method, a lifetime or a
/// binding.
fn named_paths<'a>(code: &[Token<'a>]) -> Vec<Vec<&'a str>> {
    let text = |at: usize| code.get(at).map_or("", |token| token.text);
    let separator = |at: usize| [text(at), text(at + 1)] == [":", ":"];
    let mut paths = Vec::new();
    let mut at = 0;
    while at < code.len() {
        let start = at;
        at += 1;
        let before = |steps: usize| start.checked_sub(steps).map_or("", text);
        let is_field = before(1) == "." && before(2) != ".";
        let continues = before(1) == ":" && before(2) == ":";
        if !is_name(text(start))
            || is_field
            || continues
            || matches!(before(1), "'" | "$" if text(start) != "crate")
        {
            continue;
        }

        // Collect the segments up to generic arguments or the end of the path.
        let mut path = vec![text(start)];
        while separator(at) && is_name(text(at + 2)) {
            path.push(text(at + 2));
            at += 3;
        }
        let binds = matches!(before(1), "fn" | "let" | "mut" | "ref")
            || (text(at) == ":" && !separator(at));
        if path.len() > 1 || !binds {
            paths.push(path);
        }
    }
    paths
}

fn is_name(text: &str) -> bool {
    text != "_" && text.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

/// The look-ups that wait for an inner one, so that imports in a circle come to an end: module,
/// name, and whether a module is wanted.
type Open<'a> = BTreeSet<(usize, &'a str, bool)>;

/// Looks names up.
struct Scope<'m, 'a> {
    modules: &'m [Module<'a>],
}

impl<'a> Scope<'_, 'a> {
    /// Follows a path that stands in module `from`; `None` for a name that no item of the crate
    /// has.
    fn resolve(&self, from: usize, path: &[&'a str], open: &mut Open<'a>) -> Option<Target<'a>> {
        let (first, rest) = path.split_first()?;
        let mut target = match *first {
            "" => Target::Outside,
            "crate" => Target::Module(0),
            "self" => Target::Module(from),
            "super" => Target::Module(self.modules[from].parent),
            name => self.look_up(from, name, !rest.is_empty(), open)?,
        };
        for (at, name) in rest.iter().enumerate() {
            let Target::Module(module) = target else { return Some(target) };
            target = match *name {
                "super" => Target::Module(self.modules[module].parent),
                name => match self.look_up(module, name, at + 1 < rest.len(), open) {
                    Some(target) => target,
                    // A macro defines the name here, or it comes with all names of another crate.
                    None if self.hands_on_others(module) => Target::Outside,
                    None => Target::Item(module, name),
                },
            };
        }
        Some(target)
    }

    /// What a name means in a module. Modules and items may share a name: `as_module` says which is
    /// wanted.
    fn look_up(
        &self,
        module: usize,
        name: &'a str,
        as_module: bool,
        open: &mut Open<'a>,
    ) -> Option<Target<'a>> {
        if !open.insert((module, name, as_module)) {
            return None;
        }

        // Collect what the module itself calls so.
        let Module { children, items, imports, .. } = &self.modules[module];
        let mut found: Vec<Target<'a>> = Vec::new();
        found.extend(items.contains(name).then_some(Target::Item(module, name)));
        found.extend(children.get(name).map(|&child| Target::Module(child)));
        for import in imports.iter().filter(|import| import.binding == Binding::Name(name)) {
            found.push(self.resolve(module, &import.path, open).unwrap_or(Target::Outside));
        }

        // Try globs for other names only: a module's own names hide those that globs bring.
        if found.is_empty() {
            for import in imports.iter().filter(|import| import.binding == Binding::Glob) {
                if let Some(Target::Module(other)) = self.resolve(module, &import.path, open) {
                    found.extend(self.look_up(other, name, as_module, open));
                }
            }
        }
        open.remove(&(module, name, as_module));

        // Prefer the kind that is wanted.
        let wanted = |target: &&Target<'a>| matches!(target, Target::Module(_)) == as_module;
        found.iter().find(wanted).or(found.first()).copied()
    }

    /// Whether a module imports all names of another crate's module.
    fn hands_on_others(&self, module: usize) -> bool {
        let globs = |import: &&Import<'a>| import.binding == Binding::Glob;
        let outside = |import: &Import<'a>| {
            matches!(
                self.resolve(module, &import.path, &mut Open::new()),
                None | Some(Target::Outside)
            )
        };
        self.modules[module].imports.iter().filter(globs).any(outside)
    }
}
