//! What was odd in a file but could be read: collected by kind, so that a million odd lines make
//! one message.

use crate::Place;

/// One kind of oddity: the first place, and how often it was met.
#[derive(Clone, Debug)]
struct Entry {
    kind: &'static str,
    place: Place,
    what: String,
    count: u64,
}

/// The warnings of one file (or of one piece of it), in the order in which the kinds first
/// appeared.
#[derive(Clone, Debug, Default)]
pub(crate) struct Warnings {
    entries: Vec<Entry>,
}

impl Warnings {
    /// Notes an oddity. `what` is only evaluated for the first of its `kind`; later ones are
    /// counted. A kind of `""` is always a message of its own.
    pub(crate) fn note(&mut self, kind: &'static str, place: Place, what: impl FnOnce() -> String) {
        match self.entries.iter_mut().find(|e| e.kind == kind && !kind.is_empty()) {
            Some(entry) => entry.count += 1,
            None => self.entries.push(Entry { kind, place, what: what(), count: 1 }),
        }
    }

    /// Adds the warnings of a later piece of the file, which begins after `lines` lines.
    pub(crate) fn append(&mut self, later: Self, lines: u64) {
        for mut entry in later.entries {
            if let Place::Line(line) = &mut entry.place {
                *line += lines;
            }
            match self.entries.iter_mut().find(|e| e.kind == entry.kind && !entry.kind.is_empty()) {
                Some(earlier) => earlier.count += entry.count,
                None => self.entries.push(entry),
            }
        }
    }

    /// The messages, for the user: `FILE: PLACE: WHAT (and N more)`.
    pub(crate) fn into_messages(self, file: &str) -> Vec<String> {
        let message = |e: Entry| match e.count {
            1 => format!("{file}: {}{}", e.place, e.what),
            n => format!("{file}: {}{} (and {} more of the kind)", e.place, e.what, n - 1),
        };
        self.entries.into_iter().map(message).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_message_a_kind() {
        let (mut a, mut b) = (Warnings::default(), Warnings::default());
        a.note("k", Place::Line(3), || "odd".into());
        b.note("k", Place::Line(1), || "also odd".into());
        b.note("other", Place::Line(2), || "strange".into());
        a.append(b, 10);
        assert_eq!(
            a.into_messages("f"),
            ["f: line 3: odd (and 1 more of the kind)", "f: line 12: strange"]
        );
    }
}
