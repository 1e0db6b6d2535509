//! The record of finished jobs: a line of JSON for each, with the files that it read and wrote. A
//! job counts as finished while all files of its last line have the contents that they had.

use super::job::Task;
use crate::hashes::hash_of;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, HashMap};
use std::fs::{File, OpenOptions};
use std::io::{ErrorKind, Read, Seek, SeekFrom, Write};
use std::path::Path;

/// A job that was done.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Entry {
    /// The hash of the job.
    pub(crate) job: String,
    /// Its name.
    pub(crate) id: String,
    /// The files that it read, with the hashes of their contents.
    pub(crate) inputs: BTreeMap<String, String>,
    /// The files that it wrote.
    pub(crate) outputs: BTreeMap<String, String>,
    /// What it took.
    pub(crate) seconds: f64,
    /// The version that did it.
    pub(crate) vitral: String,
}

/// All that is recorded, and the hashes of files that were looked at.
#[derive(Debug, Default)]
pub(crate) struct Record {
    entries: HashMap<String, Entry>,
    hashes: HashMap<String, Option<String>>,
}

impl Record {
    /// Reads a record; one that is not there is empty. Lines that were cut short by the end of a
    /// process count for nothing.
    pub(crate) fn read(path: &Path) -> std::io::Result<Self> {
        let mut bytes = Vec::new();
        match File::open(path) {
            Ok(mut file) => file.read_to_end(&mut bytes).map(|_| ())?,
            Err(e) if e.kind() == ErrorKind::NotFound => {}
            Err(e) => return Err(e),
        }
        let lines = bytes.split(|byte| *byte == b'\n');
        let entries = lines.filter_map(|line| serde_json::from_slice::<Entry>(line).ok());
        Ok(Self {
            entries: entries.map(|entry| (entry.job.clone(), entry)).collect(),
            hashes: HashMap::new(),
        })
    }

    /// Whether a task is done, and nothing that it read or wrote has changed.
    pub(crate) fn has(&mut self, task: &Task) -> bool {
        let Some(entry) = self.entries.get(&task.hash()) else { return false };
        let mut files = entry.outputs.iter().chain(&entry.inputs);
        let hashes = &mut self.hashes;
        files.all(|(path, hash)| {
            hashes.entry(path.clone()).or_insert_with(|| hash_of(path)).as_ref() == Some(hash)
        })
    }
}

/// Adds a line, in one write at the end of the file, behind whatever another process has added.
pub(crate) fn append(path: &Path, entry: &Entry) -> std::io::Result<()> {
    let mut file = OpenOptions::new().create(true).read(true).append(true).open(path)?;
    let mut line = serde_json::to_vec(entry).map_err(std::io::Error::other)?;
    line.push(b'\n');

    // A line that was cut short must not swallow this one.
    let length = file.metadata()?.len();
    if length > 0 {
        let mut last = [0];
        file.seek(SeekFrom::Start(length - 1))?;
        file.read_exact(&mut last)?;
        if last != *b"\n" {
            line.insert(0, b'\n');
        }
    }
    file.write_all(&line)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_job_is_done_while_its_files_are_what_they_were() {
        let folder = std::env::temp_dir().join(format!("vitral-record-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let name = |file: &str| folder.join(file).to_string_lossy().into_owned();
        let (record, model, output) =
            (folder.join("jobs.done.jsonl"), name("a.obj"), name("a.png"));
        std::fs::write(&model, "model").unwrap();
        std::fs::write(&output, "picture").unwrap();
        let task = Task {
            models: vec![model.clone()],
            output: output.clone(),
            command: vec!["render".to_owned()],
        };
        assert!(!Record::read(&record).unwrap().has(&task));

        // A line that was cut short lies before ours.
        std::fs::write(&record, "{\"job\": \"ab").unwrap();
        let hashes = |file: &str| BTreeMap::from([(file.to_owned(), hash_of(file).unwrap())]);
        let entry = Entry {
            job: task.hash(),
            id: "a".to_owned(),
            inputs: hashes(&model),
            outputs: hashes(&output),
            seconds: 0.5,
            vitral: "0".to_owned(),
        };
        append(&record, &entry).unwrap();
        append(&record, &Entry { job: "other".to_owned(), ..entry }).unwrap();
        assert!(Record::read(&record).unwrap().has(&task));
        std::fs::write(&model, "changed").unwrap();
        assert!(!Record::read(&record).unwrap().has(&task));
        std::fs::write(&model, "model").unwrap();
        std::fs::remove_file(&output).unwrap();
        assert!(!Record::read(&record).unwrap().has(&task));
        std::fs::remove_dir_all(folder).unwrap();
    }
}
