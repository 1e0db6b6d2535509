//! The modules of a crate, as its source files declare them: items, imports, and the code between.
//!
//! Items under `#[cfg(test)]` are left out, and with them the files that only tests have.

use crate::check::tokens::{Token, group_length, tokens, without_tests};
use std::collections::{BTreeMap, BTreeSet};

/// The source files of a crate by their paths below `src`.
pub(in crate::check) type Sources<'a> = BTreeMap<&'a str, &'a str>;

/// What a module holds.
#[derive(Debug, Default)]
pub(super) struct Module<'a> {
    /// Path of its file below `src`.
    pub(super) file: String,
    /// The module that declares it; itself for the root.
    pub(super) parent: usize,
    pub(super) children: BTreeMap<&'a str, usize>,
    /// Names of the items that it defines, modules excepted.
    pub(super) items: BTreeSet<&'a str>,
    /// Its `use` declarations, those inside functions too.
    pub(super) imports: Vec<Import<'a>>,
    /// All other code.
    pub(super) code: Vec<Token<'a>>,
}

/// One leaf of a `use` tree.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Import<'a> {
    /// Segments; the first is empty for a path that starts with `::`.
    pub(super) path: Vec<&'a str>,
    pub(super) binding: Binding<'a>,
    /// Whether the declaration has a visibility and so hands the name on.
    pub(super) public: bool,
}

/// What an import brings into its module.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Binding<'a> {
    Name(&'a str),
    Glob,
}

/// Reads the modules that can be reached from the file `root`, which is module 0.
pub(super) fn read_modules<'a>(sources: &Sources<'a>, root: &str) -> Vec<Module<'a>> {
    let mut reader = Reader { sources, modules: Vec::new() };
    reader.read_file(root.to_owned(), String::new(), 0);
    reader.modules
}

struct Reader<'s, 'a> {
    sources: &'s Sources<'a>,
    modules: Vec<Module<'a>>,
}

impl<'a> Reader<'_, 'a> {
    /// Reads a file as a module; `folder` is where the files of its children are, with `/` at the
    /// end unless empty.
    fn read_file(&mut self, file: String, folder: String, parent: usize) -> usize {
        let text = self.sources.get(file.as_str()).copied().unwrap_or_default();
        self.read_module(&without_tests(&tokens(text)), file, &folder, parent)
    }

    /// Reads a module from the tokens between its braces, or of its file.
    fn read_module(
        &mut self,
        code: &[Token<'a>],
        file: String,
        folder: &str,
        parent: usize,
    ) -> usize {
        let index = self.modules.len();
        self.modules.push(Module { file: file.clone(), parent, ..Module::default() });
        let mut at = 0;
        while at < code.len() {
            let item = Item::read(&code[at..]);
            let tokens = &code[at..at + item.length];
            at += item.length;

            // Enter child modules, inline ones and those with files.
            if let (Kind::Module, Some(name)) = (item.kind, item.name) {
                let below = format!("{folder}{name}/");
                let child = match tokens.iter().position(|token| token.text == "{") {
                    Some(open) => self.read_module(
                        &tokens[open + 1..tokens.len() - 1],
                        file.clone(),
                        &below,
                        index,
                    ),
                    None => {
                        let folder_file = format!("{below}mod.rs");
                        let is_folder = self.sources.contains_key(folder_file.as_str());
                        let file =
                            if is_folder { folder_file } else { format!("{folder}{name}.rs") };
                        self.read_file(file, below, index)
                    }
                };
                self.modules[index].children.insert(name, child);
                continue;
            }

            // Take the name and the contents of any other item.
            let module = &mut self.modules[index];
            module.items.extend(item.name);
            read_code(tokens, module);
        }
        index
    }
}

/// What the reader tells apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Module,
    /// Ends with its braces, or with a semicolon before any.
    Braced,
    /// Ends with a semicolon, whatever braces stand before it.
    Terminated,
}

/// An item at the start of some tokens.
struct Item<'a> {
    kind: Kind,
    name: Option<&'a str>,
    length: usize,
}

impl<'a> Item<'a> {
    fn read(tokens: &[Token<'a>]) -> Self {
        let text = |at: usize| tokens.get(at).map_or("", |token| token.text);

        // Skip attributes, the visibility and what may stand before `fn`.
        let mut at = 0;
        loop {
            at += match (text(at), text(at + 1)) {
                ("#", "!") => 2 + group_length(&tokens[at + 2..]),
                ("#", _) => 1 + group_length(&tokens[at + 1..]),
                ("pub", "(") => 1 + group_length(&tokens[at + 1..]),
                ("pub" | "unsafe" | "async", _)
                | ("const" | "extern", "fn" | "unsafe" | "async" | "extern") => 1,
                _ => break,
            };
        }

        // Tell the kind and the name.
        let (kind, name_at) = match (text(at), text(at + 1)) {
            ("mod", _) => (Kind::Module, Some(at + 1)),
            ("fn" | "struct" | "enum" | "union" | "trait", _) => (Kind::Braced, Some(at + 1)),
            ("macro_rules", "!") => (Kind::Braced, Some(at + 2)),
            ("static", "mut") => (Kind::Terminated, Some(at + 2)),
            ("const" | "static" | "type", _) => (Kind::Terminated, Some(at + 1)),
            ("use", _) => (Kind::Terminated, None),
            _ => (Kind::Braced, None),
        };
        let name = name_at.and_then(|at| tokens.get(at)).map(|token| token.text);

        // Find the end.
        while at < tokens.len() {
            match text(at) {
                ";" => return Self { kind, name, length: at + 1 },
                "{" if kind != Kind::Terminated => {
                    return Self { kind, name, length: at + group_length(&tokens[at..]) };
                }
                "(" | "[" | "{" => at += group_length(&tokens[at..]),
                _ => at += 1,
            }
        }
        Self { kind, name, length: tokens.len() }
    }
}

/// Sorts the tokens of an item into imports and other code.
fn read_code<'a>(tokens: &[Token<'a>], module: &mut Module<'a>) {
    let mut at = 0;
    while at < tokens.len() {
        // `use<'a>` in a type is no import.
        let is_import =
            tokens[at].text == "use" && tokens.get(at + 1).is_some_and(|next| next.text != "<");
        if !is_import {
            module.code.push(tokens[at]);
            at += 1;
            continue;
        }
        let public = at > 0 && matches!(tokens[at - 1].text, "pub" | ")");
        at += 1;
        read_tree(tokens, &mut at, Vec::new(), public, &mut module.imports);
    }
}

/// Reads the `use` tree at `at`, with the segments before it.
fn read_tree<'a>(
    tokens: &[Token<'a>],
    at: &mut usize,
    mut path: Vec<&'a str>,
    public: bool,
    imports: &mut Vec<Import<'a>>,
) {
    while let Some(token) = tokens.get(*at) {
        *at += 1;
        match token.text {
            "{" => {
                while tokens.get(*at).is_some_and(|token| !matches!(token.text, "}" | ";")) {
                    read_tree(tokens, at, path.clone(), public, imports);
                    *at += usize::from(tokens.get(*at).is_some_and(|token| token.text == ","));
                }
                *at += 1;
                return;
            }
            "*" => return imports.push(Import { path, binding: Binding::Glob, public }),
            ":" => {
                // Mark a path that starts with `::`.
                *at += 1;
                path.push("");
                continue;
            }
            ";" | "," | "}" => {
                *at -= 1;
                return;
            }
            "self" if !path.is_empty() => {}
            segment => path.push(segment),
        }

        // Go on after `::`, or take the name that the path is bound to.
        let text = |at: usize| tokens.get(at).map_or("", |token| token.text);
        if [text(*at), text(*at + 1)] == [":", ":"] {
            *at += 2;
            continue;
        }
        let mut name = path.last().copied().unwrap_or_default();
        if text(*at) == "as" {
            name = text(*at + 1);
            *at += 2;
        }
        return imports.push(Import { path, binding: Binding::Name(name), public });
    }
}
